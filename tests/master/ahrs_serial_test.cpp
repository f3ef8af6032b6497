// Through a pseudo-terminal, which is as much of a serial line as there is without hardware.
#include <fcntl.h>
#include <termios.h>
#include <unistd.h>

#include <cstdlib>
#include <stdexcept>

#include "common/realtime.hpp"
#include "common/recorder.hpp"
#include "common/scene.hpp"
#include "master/ahrs/ahrs_line.hpp"
#include "master/ahrs/line_fault.hpp"
#include "master/build.hpp"
#include "master/build_ahrs.hpp"

namespace farhand {
namespace {

struct Terminal {
  int file = posix_openpt(O_RDWR | O_NOCTTY);
  std::string name;
  Terminal() {
    if (file >= 0 && grantpt(file) == 0 && unlockpt(file) == 0) name = ptsname(file);
  }
  ~Terminal() { close(file); }
  void say(std::span<const std::byte> bytes) const {
    ASSERT_EQ(::write(file, bytes.data(), bytes.size()), static_cast<ssize_t>(bytes.size()));
  }
};

TEST(SerialPort, BytesComeAsTheyWereSentAndNothingBlocks) {
  const Terminal far;
  ASSERT_FALSE(far.name.empty());
  SerialPort port(far.name, 115200);
  EXPECT_TRUE(port.read().empty());  // and returns

  std::array<std::byte, 256> every;
  for (int i = 0; i < 256; ++i) every[static_cast<std::size_t>(i)] = static_cast<std::byte>(i);
  far.say(every);
  std::size_t got = 0;
  for (int i = 0; i < 1000 && got < every.size(); ++i)
    for (const std::byte b : port.read()) {
      ASSERT_EQ(b, every[got]);
      ++got;
    }
  EXPECT_EQ(got, every.size());
}

TEST(SerialPort, AFrameOverTheLineIsASample) {
  const Terminal far;
  SerialPort port(far.name, 921600);
  std::array<std::byte, kMaxFrameBytes> frame;
  const AhrsSample sent{.gyro = Vec3(1, 2, 3), .acceleration = Vec3(0, 9.5, 0)};
  far.say(std::span(frame).first(encode(sent, AhrsFormat::vectornav, frame)));
  AhrsParser parser(AhrsFormat::vectornav);
  std::optional<AhrsSample> got;
  for (int i = 0; i < 1000 && !got; ++i) parser.push(port.read()), got = parser.next();
  ASSERT_TRUE(got);
  EXPECT_EQ(got->gyro, sent.gyro);
}

// Of a grip at rest, now; what it reads about x tells which it is.
constexpr double kMark = 1e-5;  // [rad/s]
AhrsSample numbered(int i) {
  return {.gyro = Vec3(kMark * i, 0, 0),
          .acceleration = Vec3(0, kGravity, 0),
          .time = monotonic_now().time_since_epoch()};
}
int number_of(const AhrsSample& sample) {
  return static_cast<int>(std::lround(sample.gyro.x() / kMark));
}
void send(const Terminal& far, int i) {
  std::array<std::byte, kMaxFrameBytes> frame;
  far.say(std::span(frame).first(encode(numbered(i), AhrsFormat::native, frame)));
}

TEST(AhrsLine, GivesOneSampleAtATimeInOrder) {
  const Terminal far;
  AhrsLine line(far.name, 115200, AhrsFormat::native);
  EXPECT_FALSE(line.next());
  for (int i = 1; i <= 3; ++i) send(far, i);
  for (int i = 1; i <= 3; ++i) {
    std::optional<AhrsSample> got;
    for (int k = 0; k < 1000 && !got; ++k) got = line.next();
    ASSERT_TRUE(got) << i;
    EXPECT_EQ(number_of(*got), i);
  }
  EXPECT_FALSE(line.next());
}

// In real time: the sensor's first second is one. No slave is needed for it.
TEST(AhrsLine, TheLoopReadsItBesideTheDevice) {
  const Terminal far;
  const Scene scene =
      parse_scene("master { falcon {} sim_hand {} position_control {} ahrs { serial { path: \"" +
                      far.name + "\" } } }",
                  "test");
  Master master(master_config(scene.proto));
  AnyDevice device = make_device(scene, {}, 1);
  std::optional<AhrsLine> line;
  open_ahrs(scene.proto, line);
  ASSERT_TRUE(line);
  std::atomic<bool> ok = false;
  bool aligned = false, in_order = true;
  int last = 0;
  Recorder<MasterRecord> recorder([&](const MasterRecord& r) {
    aligned |= r.tick.ahrs == AhrsState::aligning;
    if (r.tick.reading.ahrs) {
      in_order &= number_of(*r.tick.reading.ahrs) == last + 1;
      last = number_of(*r.tick.reading.ahrs);
    }
    if (r.tick.ahrs == AhrsState::ok) ok = true;
  });
  MasterLoop loop(master_loop_config(scene.proto), master, device, nullptr, nullptr, &*line,
                  recorder);
  constexpr int kMostTurns = 10000;
  for (int i = 0; i < kMostTurns && !ok; ++i) {
    if (i % 5 == 0) send(far, i / 5 + 1);
    loop.turn();
  }
  recorder.stop();
  EXPECT_TRUE(ok && aligned);
  EXPECT_TRUE(in_order || recorder.lost() > 0);
  EXPECT_GT(last, 10);
}

TEST(SerialPort, SilentOnceTheOtherEndIsGone) {
  auto far = std::make_unique<Terminal>();
  SerialPort port(far->name, 115200);
  far.reset();
  EXPECT_TRUE(port.read().empty());
  EXPECT_TRUE(port.read().empty());
}

TEST(SerialPort, RefusesInASentence) {
  const auto why = [](const std::string& path, unsigned baud) -> std::string {
    try {
      SerialPort(path, baud);
    } catch (const std::runtime_error& e) {
      return e.what();
    }
    return "";
  };
  const std::string missing = why("/dev/no_such_line", 115200);
  EXPECT_NE(missing.find("/dev/no_such_line cannot be read (No such file"), std::string::npos);
  EXPECT_NE(missing.find("plug the AHRS in"), std::string::npos);
  EXPECT_NE(why("/dev/null", 115200).find("is no serial line"), std::string::npos);
  EXPECT_NE(why("/dev/null", 12345).find("12345 baud"), std::string::npos);
}

TEST(LineFault, TheDoctorSaysWhetherASerialLineMayBeRead) {
  using doctor::Level;
  const auto expect = [](const std::string& path, Level level, const char* part) {
    const auto findings =
        examine_ahrs(parse_scene("master { falcon {} sim_hand {} ahrs { serial { path: \"" + path +
                                     "\" } } } slave { sim_arm {} workspace {} joint_pid {} }",
                                 "test"));
    ASSERT_EQ(findings.size(), 1u);
    EXPECT_EQ(findings[0].level, level) << path;
    EXPECT_NE(findings[0].text.find(part), std::string::npos) << findings[0].text;
  };
  expect("/dev/no_such_line", Level::problem, "plug the AHRS in");
  expect(FARHAND_SOURCE_DIR "/README.md", Level::problem, "/dev/ttyUSB0");
  expect("/dev/null", Level::ok, "115200 baud");  // by all that is asked
  EXPECT_TRUE(
      examine_ahrs(parse_scene("master { falcon {} sim_hand {} position_control {} }", "test"))
          .empty());
  EXPECT_NE(unreadable_line("/dev/ttyS0", EACCES).find("usermod -aG"), std::string::npos);
  EXPECT_NE(unreadable_line("/dev/ttyS0", EBUSY).find("stop that one"), std::string::npos);
}

}  // namespace
}  // namespace farhand
