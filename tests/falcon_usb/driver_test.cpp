#include "master/falcon_usb/driver.hpp"

#include <gtest/gtest.h>

#include <limits>

#include "tests/falcon_usb/rig.hpp"
#include "tests/support/allocations.hpp"

namespace farhand::falcon_usb {
namespace {

constexpr EmulatorConfig kNoFirmware{};
const EmulatorConfig kRunning{.processor = {.firmware_loaded = true}};

TEST(FalconDriver, GoesFromPluggingInToTorqueInOrder) {
  const auto image = firmware_image();
  Rig rig(kNoFirmware, {.firmware = image});
  EXPECT_EQ(rig.phase(), Phase::absent);
  for (const Phase phase : {Phase::probing, Phase::uploading, Phase::homing, Phase::homed})
    EXPECT_TRUE(rig.live_until(phase)) << to_string(phase);
  EXPECT_EQ(rig.driver.status().upload_attempt, 1);
  EXPECT_TRUE(rig.arm());
  EXPECT_EQ(rig.trouble(), Trouble::none);
  EXPECT_EQ(rig.grip.driven, motor_counts(rig.tau.head<3>(), kGainCharacterised));
}

TEST(FalconDriver, FirmwareThatRunsIsNotUploadedAgain) {
  const auto image = firmware_image();
  Rig rig(kRunning, {.firmware = image});
  EXPECT_TRUE(rig.live_until(Phase::homing));
  EXPECT_EQ(rig.driver.status().upload_attempt, 0);
}

TEST(FalconDriver, SaysWhenThereIsNoFirmware) {
  Rig rig(kNoFirmware);
  EXPECT_TRUE(rig.live_until(Phase::failed));
  EXPECT_EQ(rig.trouble(), Trouble::no_firmware);
  EXPECT_FALSE(rig.drives());
  rig.emulator.load_firmware();  // or its power is back, and it had some
  EXPECT_TRUE(rig.live_until(Phase::homed));
  EXPECT_EQ(rig.trouble(), Trouble::none);
}

TEST(FalconDriver, SaysWhenTheFirmwareCannotBeUploadedOrDoesNotRun) {
  const auto image = firmware_image(100);
  Rig deaf({.processor = {.firmware_bytes = 100, .faults = {.echo_wrong = 1}}},
           {.firmware = image});
  EXPECT_TRUE(deaf.live_until(Phase::failed));
  EXPECT_EQ(deaf.trouble(), Trouble::upload_failed);
  EXPECT_EQ(deaf.driver.status().upload_fault, UploadFault::echo_wrong);
  Rig idle({.processor = {.firmware_bytes = 101}}, {.firmware = image});
  EXPECT_TRUE(idle.live_until(Phase::failed));
  EXPECT_EQ(idle.trouble(), Trouble::not_running);
}

TEST(FalconDriver, SaysWhyItCannotBeOpened) {
  for (const auto& [refusal, trouble] :
       {std::pair{Refusal::permission, Trouble::permission},
        std::pair{Refusal::busy, Trouble::busy}, std::pair{Refusal::other, Trouble::cannot_open}}) {
    Rig rig;
    rig.emulator.plug(rig.now, true, refusal);
    EXPECT_TRUE(rig.live_until(Phase::failed));
    EXPECT_EQ(rig.trouble(), trouble);
    rig.emulator.plug(rig.now);
    EXPECT_TRUE(rig.live_until(Phase::homing));
    EXPECT_EQ(rig.trouble(), Trouble::none);
  }
}

TEST(FalconDriver, SaysWhenTheChipTakesNoRequests) {
  Driver driver({});
  driver.hear({.kind = EventKind::attached}, kStart);
  for (int i = 0; i < 4; ++i) {
    EXPECT_EQ(driver.status().phase, Phase::setting_up);
    EXPECT_TRUE(driver.next(kStart));
    EXPECT_FALSE(driver.next(kStart));  // one at a time
    driver.hear({.kind = EventKind::failed}, kStart);
  }
  EXPECT_EQ(driver.status().phase, Phase::failed);
  EXPECT_EQ(driver.status().trouble, Trouble::request_failed);
  EXPECT_FALSE(driver.next(kStart));
}

TEST(FalconDriver, NoTorqueLeavesBeforeHomingNorBeforeTheGesture) {
  Rig rig;
  rig.grip.swings = false;
  rig.grip.buttons = kGesture;
  for (int i = 0; i < 2000; ++i) {
    rig.live(1ms);
    ASSERT_FALSE(rig.drives());
    ASSERT_FALSE(rig.driver.read(rig.now).ok);
  }
  EXPECT_EQ(rig.phase(), Phase::homing);
  rig.grip.swings = true;  // the buttons stay down: they were never seen released
  for (int i = 0; i < 3000; ++i) {
    rig.live(1ms);
    ASSERT_FALSE(rig.drives());
  }
  EXPECT_EQ(rig.phase(), Phase::homed);
  EXPECT_TRUE(rig.driver.read(rig.now).ok);
  rig.grip.buttons = kButtonCentre;  // one is not both
  rig.live(2s);
  rig.grip.buttons = kGesture;
  rig.live(490ms);
  EXPECT_FALSE(rig.drives());
  rig.live(20ms);
  EXPECT_TRUE(rig.drives());
}

TEST(FalconDriver, LightsTellThePhase) {
  Rig rig;
  rig.grip.swings = false;
  rig.live(500ms);
  EXPECT_EQ(rig.emulator.processor().command().leds, kLedRed);
  rig.grip.swings = true;
  rig.live_until(Phase::homed);
  rig.live(10ms);
  EXPECT_EQ(rig.emulator.processor().command().leds, kLedBlue);
  rig.arm();
  EXPECT_EQ(rig.emulator.processor().command().leds, kLedGreen);
}

TEST(FalconDriver, ReadsAnglesAndButtonsAsTheyAre) {
  Rig rig;
  ASSERT_TRUE(rig.arm());
  rig.grip.swings = false;
  rig.grip.place = {100, -200, 300};
  rig.live(200ms);
  HandleReading reading = rig.driver.read(rig.now);
  ASSERT_TRUE(reading.ok);
  EXPECT_EQ(Vec3(reading.theta.head<3>()), theta1_from_counts(kFalconTable1, {100, -200, 300}));
  EXPECT_EQ(Vec3(reading.theta.tail<3>()), Vec3::Zero());
  EXPECT_FALSE(reading.dead_man || reading.clutch || reading.has_force);
  rig.grip.buttons = kButtonCentre;
  rig.live(10ms);
  reading = rig.driver.read(rig.now);
  EXPECT_TRUE(reading.dead_man && !reading.clutch);
  rig.grip.buttons = kButtonForward;
  rig.live(10ms);
  reading = rig.driver.read(rig.now);
  EXPECT_TRUE(!reading.dead_man && reading.clutch);
}

// Centre and forward are also dead-man and clutch: the operator's only once all were let go.
TEST(FalconDriver, TheGestureItselfPressesNothing) {
  Rig rig;
  ASSERT_TRUE(rig.live_until(Phase::homed));
  rig.grip.buttons = kButtonCentre;
  rig.live(50ms);
  EXPECT_FALSE(rig.driver.read(rig.now).dead_man) << "not armed";
  rig.grip.buttons = 0;
  rig.live(10ms);
  rig.grip.buttons = kGesture;
  ASSERT_TRUE(rig.live_until(Phase::armed));
  rig.live(50ms);
  rig.grip.buttons = kButtonCentre;  // forward let go, centre still held
  rig.live(50ms);
  EXPECT_TRUE(rig.driver.read(rig.now).ok);
  EXPECT_FALSE(rig.driver.read(rig.now).dead_man);
  rig.grip.buttons = 0;
  rig.live(10ms);
  rig.grip.buttons = kButtonCentre;
  rig.live(10ms);
  EXPECT_TRUE(rig.driver.read(rig.now).dead_man);
}

// ---- torque

TEST(FalconDriver, TorqueRisesAtItsRateAndIsCapped) {
  DriverConfig config{.max_torque = 0.5, .rise_time_s = 0.05};
  Rig rig(kRunning, config);
  rig.tau.head<3>() << 100, -50, 0;
  ASSERT_TRUE(rig.live_until(Phase::homed));
  rig.live(10ms);
  rig.grip.buttons = kGesture;
  rig.live_until(Phase::armed);
  const double counts_per_s = 0.5 / 0.05 * -kGainCharacterised;
  int last = 0;
  for (int i = 0; i < 100; ++i) {
    rig.live(1ms);
    ASSERT_LE(std::abs(rig.grip.driven[0] - last), counts_per_s * 0.002 + 1);
    last = rig.grip.driven[0];
  }
  EXPECT_EQ(rig.grip.driven, motor_counts(Vec3(0.5, -0.25, 0), kGainCharacterised));
}

TEST(FalconDriver, ATorqueThatIsNotFiniteIsNone) {
  Rig rig;
  ASSERT_TRUE(rig.arm());
  rig.tau[1] = std::numeric_limits<double>::quiet_NaN();
  rig.live(5ms);
  EXPECT_FALSE(rig.drives());
}

TEST(FalconDriver, TorqueEndsWhenTheLoopStopsWriting) {
  Rig rig;
  ASSERT_TRUE(rig.arm());
  run(rig.emulator, rig.driver, rig.now, rig.now + DriverConfig{}.unwritten + 10ms);
  EXPECT_FALSE(rig.drives());
  EXPECT_EQ(rig.phase(), Phase::armed);
  rig.live(50ms);
  EXPECT_TRUE(rig.drives());
}

// Questions still arrive, answers do not. The bound: the time without an answer, the time to the
// next question, and its way.
TEST(FalconDriver, TorqueEndsWithin13MsOfTheLastAnswer) {
  Rig rig;
  ASSERT_TRUE(rig.arm());
  rig.emulator.set_faults({.lost = 1}, {});
  const TimePoint last = rig.driver.sample()->at;
  while (rig.drives()) rig.live(100us);
  EXPECT_LE(rig.now - last, 13ms);
  EXPECT_GE(rig.now - last, DriverConfig{}.unanswered);
  rig.emulator.set_faults({}, {});
  rig.live(60ms);
  EXPECT_EQ(rig.phase(), Phase::armed);  // an outage this short needs no new gesture
  EXPECT_TRUE(rig.drives());
}

TEST(FalconDriver, ClosesWithZeroTorqueFirst) {
  Rig rig;
  ASSERT_TRUE(rig.arm());
  EXPECT_TRUE(rig.drives());
  rig.driver.close(rig.now);
  rig.live(10ms);
  EXPECT_TRUE(rig.driver.closed());
  EXPECT_FALSE(rig.drives());
  EXPECT_EQ(rig.emulator.processor().command().leds, 0);
  const std::uint64_t drives = rig.grip.drives;
  rig.live(100ms);
  EXPECT_EQ(rig.grip.drives, drives);
}

TEST(FalconDriver, ClosesInTimeWhenNobodyAnswers) {
  Rig rig;
  ASSERT_TRUE(rig.arm());
  rig.emulator.cut_power();
  rig.driver.close(rig.now);
  rig.live(DriverConfig{}.close_time + 1ms);
  EXPECT_TRUE(rig.driver.closed());
}

// ---- what goes wrong

TEST(FalconDriver, AnUnplugIsSaidAndTheWayBackIsByTheGesture) {
  Rig rig;
  ASSERT_TRUE(rig.arm());
  for (const bool power_kept : {true, false}) {
    rig.emulator.unplug(rig.now);
    rig.live(1ms);
    EXPECT_EQ(rig.phase(), Phase::absent);
    EXPECT_EQ(rig.trouble(), Trouble::unplugged);
    EXPECT_FALSE(rig.driver.read(rig.now).ok);
    rig.live(1s);
    rig.grip.driven = {};
    rig.grip.buttons = kGesture;
    rig.emulator.plug(rig.now, power_kept);
    if (!power_kept) rig.emulator.load_firmware();
    for (int i = 0; i < 3000; ++i) {
      rig.live(1ms);
      ASSERT_FALSE(rig.drives());
    }
    EXPECT_EQ(rig.phase(), Phase::homed);
    EXPECT_TRUE(rig.arm());
    EXPECT_TRUE(rig.drives());
  }
  EXPECT_EQ(rig.driver.status().unplugged, 2u);
}

TEST(FalconDriver, SilenceIsSaidWithin100Ms) {
  Rig rig;
  ASSERT_TRUE(rig.arm());
  rig.emulator.cut_power();
  const TimePoint cut = rig.now;
  while (rig.phase() == Phase::armed) rig.live(1ms);
  EXPECT_LE(rig.now - cut, 100ms);
  EXPECT_EQ(rig.trouble(), Trouble::silent);
  EXPECT_FALSE(rig.driver.read(rig.now).ok);
}

TEST(FalconDriver, PowerThatComesBackNeedsFirmwareHomingAndTheGesture) {
  const auto image = firmware_image();
  Rig rig(kRunning, {.firmware = image});
  ASSERT_TRUE(rig.arm());
  rig.emulator.cut_power();
  rig.live(200ms);
  rig.emulator.restore_power();
  rig.grip.driven = {};
  EXPECT_TRUE(rig.live_until(Phase::uploading));
  EXPECT_TRUE(rig.live_until(Phase::homing));
  EXPECT_TRUE(rig.live_until(Phase::homed));
  EXPECT_FALSE(rig.drives());
  EXPECT_TRUE(rig.arm());
}

TEST(FalconDriver, AZeroThatJumpsIsNotBelievedAndTheDeviceHomesAgain) {
  Rig rig;
  ASSERT_TRUE(rig.arm());
  rig.grip.swings = false;
  rig.live(300ms);
  const auto before = rig.driver.sample()->answer.encoders;
  rig.grip.jump = {500, 0, 0};
  for (int i = 0; i < 20 && rig.phase() == Phase::armed; ++i) {
    rig.live(1ms);
    if (rig.phase() == Phase::armed) {
      EXPECT_EQ(rig.driver.sample()->answer.encoders, before);
    }
  }
  EXPECT_EQ(rig.phase(), Phase::homing);
  EXPECT_EQ(rig.trouble(), Trouble::jumped);
  rig.live(2ms);
  EXPECT_FALSE(rig.drives());
  rig.live(1s);
  EXPECT_EQ(rig.phase(), Phase::homing);  // the device has forgotten its homing, and the grip rests
  EXPECT_FALSE(rig.emulator.processor().homed());
  rig.grip.swings = true;
  EXPECT_TRUE(rig.arm());
}

// ---- time

TEST(FalconDriver, AskedByTheDevicesClockItSamplesAt1KHzAndATorqueIsLateByOnePacket) {
  Rig rig(kRunning, {.rise_time_s = 1e-6, .pacing = Pacing::device});
  ASSERT_TRUE(rig.arm());
  const std::uint64_t before = rig.driver.status().exchange.accepted;
  rig.live(1s);
  EXPECT_NEAR(static_cast<double>(rig.driver.status().exchange.accepted - before), 1000, 1);
  Random random(1);
  for (int i = 0; i < 100; ++i) {
    rig.live(from_seconds(0.01 * random.uniform()));
    rig.tau = -rig.tau;
    const AxisWords wanted = motor_counts(rig.tau.head<3>(), kGainCharacterised);
    const TimePoint written = rig.now;
    rig.driver.write(rig.now, rig.tau);
    while (rig.grip.driven != wanted) rig.live(10us);
    // One exchange until the next question, and its way there.
    ASSERT_LE(rig.now - written, 1300us);
  }
}

// A loop that looks in when it reads and when it writes, wherever the chip's timer stands.
TEST(FalconDriver, PolledTwiceAMillisecondItSamplesAt1KHzToo) {
  for (const Duration phase : {0us, 200us, 400us, 600us, 800us}) {
    Rig rig;
    ASSERT_TRUE(rig.arm());
    rig.now += phase;
    const std::uint64_t before = rig.driver.status().exchange.accepted;
    for (int i = 0; i < 1000; ++i) {
      pump(rig.emulator, rig.driver, rig.now);
      rig.now += 300us;
      rig.driver.write(rig.now, rig.tau);
      pump(rig.emulator, rig.driver, rig.now);
      rig.now += 700us;
    }
    const std::uint64_t samples = rig.driver.status().exchange.accepted - before;
    EXPECT_NEAR(static_cast<double>(samples), 1000, 1);
  }
}

TEST(FalconDriver, NothingAllocates) {
  Rig rig;
  ASSERT_TRUE(rig.arm());
  EXPECT_EQ(allocations_in([&] {
              rig.live(1s);
              rig.emulator.unplug(rig.now);
              rig.live(10ms);
              rig.emulator.plug(rig.now);
              rig.live(1s);
            }),
            0u);
}

}  // namespace
}  // namespace farhand::falcon_usb
