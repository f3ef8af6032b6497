// The driver's requests: in which order they are made, and what becomes of those that fail or hang.
#include <gtest/gtest.h>

#include <cstdio>

#include "tests/falcon_usb/rig.hpp"

namespace farhand::falcon_usb {
namespace {

const EmulatorConfig kRunning{.processor = {.firmware_loaded = true}};
constexpr BusFaults kWritesFail{.failed = 1, .struck = RequestKind::write};
constexpr BusFaults kWritesHang{.hung = 1, .struck = RequestKind::write};
constexpr BusFaults kWritesHangLong{.hung = 1, .hang_time = 1s, .struck = RequestKind::write};

// ---- their order

std::string hex(std::span<const std::byte> bytes) {
  std::string out;
  for (const std::byte b : bytes) {
    char digits[3];
    std::snprintf(digits, sizeof digits, "%02x", std::to_integer<unsigned>(b));
    out += digits;
  }
  return out;
}

// "request value" of a control, or the bytes.
std::string text(const Request& request) {
  if (!request.is_control) return hex(request.data.view());
  char out[16];
  std::snprintf(out, sizeof out, "%u %04x", request.control.request, request.control.value);
  return out;
}

const std::string kProbe = "3c4141414141414141414141414a413e";  // no torque, homing, red

// Passes everything on and notes what is asked for.
struct Noted {
  Driver driver;
  std::vector<std::string> asked{};

  void hear(const Event& event, TimePoint now) noexcept { driver.hear(event, now); }
  std::optional<Request> next(TimePoint now) noexcept {
    const auto request = driver.next(now);
    if (request) asked.push_back(text(*request));
    return request;
  }
  TimePoint due() const noexcept { return driver.due(); }
  bool live_until(Emulator& emulator, TimePoint& now, Phase phase) {
    for (int i = 0; i < 1000 && driver.status().phase != phase; ++i)
      run(emulator, *this, now, now + 1ms);
    return driver.status().phase == phase;
  }
};

const std::vector<std::string> kOpening{"0 0001", "0 0002", "9 0001", "3 0002", "0 0001", "0 0002"};

TEST(FalconRequests, AFalconThatRunsIsOpenedInThisOrder) {
  ScriptedGrip grip;
  Emulator emulator(kRunning, grip.mechanism());
  Noted noted{Driver({})};
  TimePoint now = kStart;
  emulator.plug(now);
  ASSERT_TRUE(noted.live_until(emulator, now, Phase::homing));
  auto expected = kOpening;
  expected.push_back(kProbe);
  noted.asked.resize(expected.size());
  EXPECT_EQ(noted.asked, expected);
}

TEST(FalconRequests, FirmwareIsUploadedInThisOrder) {
  const auto image = firmware_image(130);
  ScriptedGrip grip;
  Emulator emulator({.processor = {.firmware_bytes = 130}}, grip.mechanism());
  Noted noted{Driver({.firmware = image})};
  TimePoint now = kStart;
  emulator.plug(now);
  ASSERT_TRUE(noted.live_until(emulator, now, Phase::homing));
  std::erase(noted.asked, kProbe);
  auto expected = kOpening;
  for (const char* boot : {"0 0001", "0 0002", "9 0010", "3 4138", "4 0008", "2 0000", "1 0200",
                           "1 0100", "1 0101", "0a430d", "1 0100", "3 0015", "41"})
    expected.emplace_back(boot);
  for (const std::size_t begin : {0u, 62u, 124u})
    expected.push_back(
        hex(std::span(image).subspan(begin, std::min<std::size_t>(62, 130 - begin))));
  expected.insert(expected.end(), kOpening.begin(), kOpening.end());
  EXPECT_EQ(noted.asked, expected);
}

// The chip remembers nothing of how it was set up before.
TEST(FalconRequests, APacketIsNotAnsweredBeforeTheChipIsSetUpAgain) {
  Rig rig;
  ASSERT_TRUE(rig.live_until(Phase::homed));
  rig.emulator.plug(rig.now);
  rig.now += 1ms;
  while (rig.emulator.next_event(rig.now)) continue;
  rig.emulator.submit(request_of(encode(Command{})), rig.now);
  while (const Event* event = rig.emulator.next_event(rig.now + 50ms))
    if (event->kind == EventKind::received) {
      EXPECT_TRUE(payload(event->packet).empty());
    }
}

// ---- when they fail or hang

// From the question that hangs: the time it is given, setting up anew, and the way of a zero.
TEST(FalconRequests, AfterAWriteThatHangsZeroIsAtTheMotorsWithin6Ms) {
  Rig rig;
  ASSERT_TRUE(rig.arm());
  rig.emulator.set_faults({}, kWritesHang);
  const std::uint64_t asked = rig.driver.status().exchange.asked;
  while (rig.driver.status().exchange.asked == asked) rig.live(10us);
  rig.emulator.set_faults({}, {});
  const TimePoint hung = rig.now;
  while (rig.drives()) rig.live(10us);
  EXPECT_LE(rig.now - hung, 6ms);
  EXPECT_GE(rig.now - hung, kDataTime);
  rig.live(100ms);
  EXPECT_FALSE(rig.drives());
  EXPECT_TRUE(rig.arm());
}

TEST(FalconRequests, AHangingWriteDoesNotHoldUpSilence) {
  Rig rig;
  ASSERT_TRUE(rig.arm());
  rig.emulator.set_faults({}, kWritesHangLong);
  rig.live(1ms);
  const TimePoint last = rig.driver.sample()->at;
  while (rig.phase() == Phase::armed) rig.live(100us);
  EXPECT_LE(rig.now - last, DriverConfig{}.silent + 100us);
  EXPECT_EQ(rig.trouble(), Trouble::silent);
  EXPECT_FALSE(rig.driver.read(rig.now).ok);
  rig.emulator.set_faults({}, {});
  EXPECT_TRUE(rig.arm());
}

TEST(FalconRequests, AHangingRequestDoesNotHoldUpClosing) {
  for (const RequestKind kind : {RequestKind::write, RequestKind::control}) {
    Rig rig;
    ASSERT_TRUE(rig.arm());
    if (kind == RequestKind::control) rig.emulator.plug(rig.now);
    rig.emulator.set_faults({}, {.hung = 1, .hang_time = 1s, .struck = kind});
    rig.live(10ms);
    rig.driver.close(rig.now);
    rig.live(DriverConfig{}.close_time + 100us);
    EXPECT_TRUE(rig.driver.closed());
  }
}

TEST(FalconRequests, WritesThatFailEndInAReasonThoughControlsSucceed) {
  for (const BusFaults& faults : {kWritesFail, kWritesHang}) {
    Rig rig;
    ASSERT_TRUE(rig.live_until(Phase::homing));
    rig.emulator.set_faults({}, faults);
    ASSERT_TRUE(rig.live_until(Phase::failed));
    EXPECT_EQ(rig.trouble(), Trouble::request_failed);
  }
}

// Now and then one fails, and the next is answered.
TEST(FalconRequests, FailuresFarApartAreForgiven) {
  Rig rig;
  for (int i = 0; i < 10; ++i) {
    ASSERT_TRUE(rig.arm()) << i;
    rig.emulator.set_faults({}, kWritesFail);
    rig.live(1ms);
    rig.emulator.set_faults({}, {});
  }
}

// ---- closing

TEST(FalconRequests, AZeroTorqueThatFailsWhileClosingIsSaidAgain) {
  for (const BusFaults& faults : {kWritesFail, kWritesHang}) {
    Rig rig;
    ASSERT_TRUE(rig.arm());
    rig.emulator.set_faults({}, faults);
    rig.driver.close(rig.now);
    rig.live(30ms);
    EXPECT_TRUE(rig.drives());  // nothing got through
    EXPECT_FALSE(rig.driver.closed());
    rig.emulator.set_faults({}, {});
    rig.live(15ms);
    EXPECT_FALSE(rig.drives());
    EXPECT_TRUE(rig.driver.closed());
  }
}

// Whether the requests failed just before, or so often that the driver gave up.
TEST(FalconRequests, ClosingSaysZeroToADeviceWhoseLastTorqueIsHeld) {
  for (const Duration span : {1ms, 100ms}) {
    Rig rig;
    ASSERT_TRUE(rig.arm());
    rig.emulator.set_faults({}, kWritesFail);
    rig.live(span);
    rig.emulator.set_faults({}, {});
    ASSERT_TRUE(rig.drives());
    rig.driver.close(rig.now);
    rig.live(15ms);
    EXPECT_FALSE(rig.drives());
    EXPECT_TRUE(rig.driver.closed());
  }
}

TEST(FalconRequests, OnlyAnswersToZeroTorqueEndClosing) {
  for (const Duration offset : {0us, 200us, 400us, 600us, 800us}) {
    Rig rig;
    ASSERT_TRUE(rig.arm());
    rig.live(offset);
    rig.driver.close(rig.now);
    int zeros = 0;
    for (std::uint64_t drives = rig.grip.drives; !rig.driver.closed(); drives = rig.grip.drives) {
      rig.live(10us);
      zeros += rig.grip.drives != drives && !rig.drives();
    }
    EXPECT_GE(zeros, 3) << offset.count();
  }
}

// ---- the first sample

// The first answer of a device that is homed has one letter wrong.
TEST(FalconRequests, TheFirstSampleIsNotBelievedAlone) {
  for (std::uint64_t seed = 1; seed <= 50; ++seed) {
    Rig rig({.processor = {.firmware_loaded = true, .homed = true}, .seed = seed});
    rig.grip.swings = false;
    rig.emulator.set_faults({.altered = 1}, {});
    while (rig.driver.status().exchange.accepted == 0) rig.live(100us);
    rig.emulator.set_faults({}, {});
    while (!rig.driver.sample()) rig.live(100us);
    EXPECT_EQ(rig.driver.sample()->answer.encoders, AxisWords{}) << seed;
    EXPECT_EQ(rig.phase(), Phase::homed);
  }
}

}  // namespace
}  // namespace farhand::falcon_usb
