// The driver over the real libusb, whose kernel is a mock: life cycle and errors. Needs
// LD_PRELOAD=libumockdev-preload.so.0.
#include "master/falcon_usb/usb_transport.hpp"

#include <gtest/gtest.h>
#include <unistd.h>

#include "master/falcon_usb/driver.hpp"
#include "tests/falcon_usb/mock_bus.hpp"

namespace farhand::falcon_usb {
namespace {

struct Usb {
  explicit Usb(const EmulatorConfig& config = {.processor = {.firmware_loaded = true}},
               const DriverConfig& driver_config = {.pacing = Pacing::device},
               const std::string& serial = {})
      : bus(config), transport(serial), driver(driver_config) {}

  void step() {
    const TimePoint now = bus.advance(200us);
    transport.wait(Duration::zero(), now);
    driver.write(now, Vec6::Zero());
    pump(transport, driver, now);
  }
  // In at most so many seconds of the bus' time.
  template <typename Condition>
  bool until(Condition&& condition, int at_most_s = 10) {
    for (int i = 0; i < at_most_s * 5000 && !condition(); ++i) step();
    return condition();
  }
  bool until(Phase phase) {
    return until([&] { return driver.status().phase == phase; });
  }
  std::uint64_t accepted() const { return driver.status().exchange.accepted; }

  MockBus bus;
  UsbTransport transport;
  Driver driver;
};

TEST(UsbTransport, WithoutADeviceNothingHappens) {
  Usb usb;
  for (int i = 0; i < 1000; ++i) usb.step();
  EXPECT_EQ(usb.driver.status().phase, Phase::absent);
}

TEST(UsbTransport, ExchangesTwoThousandPackets) {
  Usb usb;
  usb.bus.plug();
  ASSERT_TRUE(usb.until(Phase::homed));
  const std::uint64_t before = usb.accepted();
  EXPECT_TRUE(usb.until([&] { return usb.accepted() == before + 2000; }));
  EXPECT_EQ(usb.transport.dropped(), 0u);
}

TEST(UsbTransport, UploadsFirmware) {
  const auto image = firmware_image(1000);
  Usb usb({.processor = {.firmware_bytes = image.size()}},
          {.pacing = Pacing::device, .firmware = image});
  usb.bus.plug();
  EXPECT_TRUE(usb.until(Phase::uploading));
  EXPECT_TRUE(usb.until(Phase::homing));
  EXPECT_EQ(usb.driver.status().upload_attempt, 1);
}

TEST(UsbTransport, AnUnplugIsSeenAndThePlugAfterIt) {
  Usb usb;
  for (int i = 0; i < 3; ++i) {
    usb.bus.plug();
    ASSERT_TRUE(usb.until(Phase::homed)) << i;
    usb.bus.unplug();
    ASSERT_TRUE(usb.until(Phase::absent)) << i;
    EXPECT_EQ(usb.driver.status().trouble, Trouble::unplugged);
  }
}

TEST(UsbTransport, ADeviceThatIsTakenIsSaidToBeAndHadOnceItIsFree) {
  Usb usb;
  usb.bus.occupy(true);
  usb.bus.plug();
  ASSERT_TRUE(usb.until(Phase::failed));
  EXPECT_EQ(usb.driver.status().trouble, Trouble::busy);
  usb.bus.occupy(false);
  EXPECT_TRUE(usb.until(Phase::homed));
}

TEST(UsbTransport, ADeviceThisUserMayNotOpenIsSaidToBe) {
  if (geteuid() == 0) GTEST_SKIP() << "root may open anything";
  Usb usb;
  usb.bus.plug();
  usb.bus.forbid();
  ASSERT_TRUE(usb.until(Phase::failed));
  EXPECT_EQ(usb.driver.status().trouble, Trouble::permission);
}

TEST(UsbTransport, TheSerialNumberChooses) {
  const EmulatorConfig config{.processor = {.firmware_loaded = true}};
  Usb mine(config, {}, MockBus::kSerial);
  mine.bus.plug();
  EXPECT_TRUE(mine.until(Phase::homing));
}

TEST(UsbTransport, AnotherSerialNumberIsLeftAlone) {
  const EmulatorConfig config{.processor = {.firmware_loaded = true}};
  Usb other(config, {}, "another");
  other.bus.plug();
  EXPECT_FALSE(other.until([&] { return other.driver.status().phase != Phase::absent; }, 1));
}

}  // namespace
}  // namespace farhand::falcon_usb
