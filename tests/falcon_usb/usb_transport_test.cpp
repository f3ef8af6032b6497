// The driver over the real libusb, whose kernel is a mock: life cycle and errors. Needs
// LD_PRELOAD=libumockdev-preload.so.0.
#include "master/falcon_usb/usb_transport.hpp"

#include <dlfcn.h>
#include <gtest/gtest.h>
#include <libusb.h>
#include <unistd.h>

#include <atomic>
#include <cerrno>
#include <optional>
#include <thread>

#include "master/falcon_usb/driver.hpp"
#include "master/falcon_usb/emulator/mock_bus.hpp"
#include "master/falcon_usb/usb_list.hpp"
#include "tests/falcon_usb/emulated_falcon.hpp"

// What is freed is counted, too.
namespace {
int freed_transfers = 0;
}  // namespace

void libusb_free_transfer(libusb_transfer* transfer) {
  ++freed_transfers;
  const auto real =
      reinterpret_cast<decltype(&libusb_free_transfer)>(dlsym(RTLD_NEXT, "libusb_free_transfer"));
  real(transfer);
}

namespace farhand::falcon_usb {
namespace {

constexpr const char* kSerial = "FH0042";

// The bus' time is a counter that the test moves, so that nothing depends on how fast the machine
// is.
struct Usb {
  explicit Usb(const EmulatorConfig& config = {.processor = {.firmware_loaded = true}},
               const DriverConfig& driver_config = {.pacing = Pacing::device},
               const std::string& serial = {})
      : bus({.emulator = config,
             .mechanism = grip.mechanism(),
             .clock = [this] { return now.load(); },
             .serial = kSerial}),
        transport(std::in_place, serial),
        driver(driver_config) {}

  void step() {
    now = now.load() + 200us;
    // Whether a device is there is found out by a thread of libusb's, which needs its time.
    if (phase() == Phase::absent || phase() == Phase::failed) std::this_thread::sleep_for(10us);
    transport->wait(Duration::zero(), now);
    driver.write(now, Vec6::Zero());
    pump(*transport, driver, now);
  }
  // In at most so many seconds of the bus' time.
  template <typename Condition>
  bool until(Condition&& condition, int at_most_s = 10) {
    for (int i = 0; i < at_most_s * 5000 && !condition(); ++i) step();
    return condition();
  }
  bool until(Phase phase) {
    return until([&] { return this->phase() == phase; });
  }
  Phase phase() const { return driver.status().phase; }
  std::uint64_t accepted() const { return driver.status().exchange.accepted; }
  bool exchanges(std::uint64_t packets) {
    return until([&, last = accepted() + packets] { return accepted() >= last; });
  }

  ScriptedGrip grip;
  std::atomic<TimePoint> now{kStart};
  MockBus bus;
  std::optional<UsbTransport> transport;
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
  EXPECT_TRUE(usb.exchanges(2000));
  EXPECT_EQ(usb.transport->dropped(), 0u);
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

// Root may open anything: for a while it is somebody else, in all threads.
class NotRoot {
 public:
  NotRoot() { EXPECT_EQ(seteuid(was_root_ ? kNobody : geteuid()), 0); }
  ~NotRoot() { EXPECT_EQ(seteuid(was_root_ ? 0 : geteuid()), 0); }
  NotRoot(const NotRoot&) = delete;
  NotRoot& operator=(const NotRoot&) = delete;

 private:
  static constexpr uid_t kNobody = 65534;
  const bool was_root_ = geteuid() == 0;
};

TEST(UsbTransport, ADeviceThisUserMayNotOpenIsSaidToBe) {
  Usb usb;
  usb.bus.plug();
  usb.bus.forbid();
  const NotRoot not_root;
  ASSERT_TRUE(usb.until(Phase::failed));
  EXPECT_EQ(usb.driver.status().trouble, Trouble::permission);
}

TEST(UsbTransport, TheSerialNumberChooses) {
  const EmulatorConfig config{.processor = {.firmware_loaded = true}};
  Usb mine(config, {}, kSerial);
  mine.bus.plug();
  EXPECT_TRUE(mine.until(Phase::homing));
}

TEST(UsbTransport, AnotherSerialNumberIsLeftAlone) {
  const EmulatorConfig config{.processor = {.firmware_loaded = true}};
  Usb other(config, {}, "another");
  other.bus.plug();
  EXPECT_FALSE(other.until([&] { return other.driver.status().phase != Phase::absent; }, 1));
}

// Not to be mistaken for another program's.
TEST(UsbTransport, ADriverOfTheKernelsIsSeenAndTakenAway) {
  Usb usb;
  usb.bus.plug();
  EXPECT_FALSE(list_falcons().at(0).kernel_driver);
  usb.bus.bind_driver();
  const Found found = list_falcons().at(0);
  EXPECT_TRUE(found.kernel_driver);
  EXPECT_EQ(found.serial, kSerial);
  EXPECT_TRUE(usb.until(Phase::homed));
}

// Of two, the one that can be had is, wherever it stands in the list.
TEST(UsbTransport, AFalconThatIsTakenDoesNotKeepTheOtherFromBeingHad) {
  for (const unsigned number : {1u, 3u})
    for (const char* serial : {"", kSerial}) {
      Usb usb;
      usb.bus.plug();
      usb.bus.plug_taken(number);
      usb.transport.emplace(serial);  // both are there when it begins to look
      EXPECT_TRUE(usb.until(Phase::homing)) << number << serial;
    }
}

// ---- requests and reads that fail or hang

// Four times, each within the time of one request and a few looks.
TEST(UsbTransport, WritesThatFailOrHangEndInAReason) {
  for (const BusFaults& faults :
       {BusFaults{.failed = 1, .struck = RequestKind::write},
        BusFaults{.hung = 1, .hang_time = 1h, .struck = RequestKind::write}}) {
    Usb usb;
    usb.bus.plug();
    ASSERT_TRUE(usb.until(Phase::homed));
    usb.bus.set_faults({}, faults);
    const TimePoint from = usb.now;
    ASSERT_TRUE(usb.until(Phase::failed));
    EXPECT_EQ(usb.driver.status().trouble, Trouble::request_failed);
    EXPECT_LE(usb.now.load() - from, 4 * (kDataTime + 5ms));
  }
}

TEST(UsbTransport, AControlThatHangsIsGivenUp) {
  Usb usb({.processor = {.firmware_loaded = true},
           .faults = {.hung = 1, .hang_time = 1h, .struck = RequestKind::control}});
  usb.bus.plug();
  ASSERT_TRUE(usb.until(Phase::failed));
  EXPECT_EQ(usb.driver.status().trouble, Trouble::request_failed);
  EXPECT_GE(usb.now.load() - kStart, 4 * kControlTime);
}

TEST(UsbTransport, ReadsThatFailAFewTimesAreMended) {
  for (const int error : {-EPIPE, -EPROTO, -EOVERFLOW}) {
    Usb usb;
    usb.bus.plug();
    ASSERT_TRUE(usb.until(Phase::homed));
    usb.bus.fail_reads(6, error);
    EXPECT_TRUE(usb.exchanges(100)) << error;
    EXPECT_EQ(usb.driver.status().unplugged, 0u);
    EXPECT_GE(usb.bus.halts_cleared(), 3);
  }
}

TEST(UsbTransport, ADeviceThatCannotBeReadIsGoneAndLookedForAnew) {
  Usb usb;
  usb.bus.plug();
  ASSERT_TRUE(usb.until(Phase::homed));
  usb.bus.fail_reads(1 << 30, -EPIPE);
  EXPECT_TRUE(usb.until(Phase::absent));
  EXPECT_LE(usb.bus.halts_cleared(), 8);
  usb.bus.fail_reads(0, 0);
  EXPECT_TRUE(usb.until(Phase::homed));
}

TEST(UsbTransport, TransfersThatDoNotEndAreNotFreed) {
  for (const bool stuck : {false, true}) {
    std::optional<Usb> usb(std::in_place);
    usb->bus.plug();
    ASSERT_TRUE(usb->until(Phase::homing));
    if (stuck) usb->bus.stick();
    freed_transfers = 0;
    usb.reset();
    // Two read; the third one, for requests, may be idle.
    if (stuck)
      EXPECT_LE(freed_transfers, 1);
    else
      EXPECT_EQ(freed_transfers, 3);
  }
}

}  // namespace
}  // namespace farhand::falcon_usb
