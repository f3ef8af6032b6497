// Through a pseudo-terminal, which is as much of a serial line as there is without hardware.
#include <fcntl.h>
#include <termios.h>
#include <unistd.h>

#include <cstdlib>
#include <stdexcept>

#include "master/ahrs/frames.hpp"
#include "master/ahrs/serial_port.hpp"

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
  EXPECT_NE(why("/dev/no_such_line", 115200).find("cannot open /dev/no_such_line"),
            std::string::npos);
  EXPECT_NE(why("/dev/null", 115200).find("is no serial line"), std::string::npos);
  EXPECT_NE(why("/dev/null", 12345).find("12345 baud"), std::string::npos);
}

}  // namespace
}  // namespace farhand
