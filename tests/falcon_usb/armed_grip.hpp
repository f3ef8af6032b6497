// The driver at an emulated Falcon whose grip a user holds still until it is armed, and then lets
// go: from that instant on the simulated handle, and whoever its configuration has, move it.
#pragma once

#include <gtest/gtest.h>

#include "master/falcon_usb/emulator/emulated_hand.hpp"
#include "tests/falcon_usb/rig.hpp"

namespace farhand::falcon_usb {

class ArmedGrip {
 public:
  // hand: starts at start_p_MH, which it must say.
  ArmedGrip(SimHandConfig hand, DriverConfig config, const EmulatedHandConfig& device = {})
      : held_(counts(*hand.start_p_MH)),
        hand_(device, std::move(hand)),
        moving_(hand_.mechanism()),
        emulator_({.processor = {.firmware_loaded = true, .homed = true}}, mechanism()),
        driver(paced_by_device(config)) {
    emulator_.plug(now);
    live(1s);
    buttons_ = kGesture;
    live(1s);
    buttons_ = 0;
    live(100ms);
    EXPECT_EQ(driver.status().phase, Phase::armed);
    free_ = true;
  }
  ArmedGrip(const ArmedGrip&) = delete;
  ArmedGrip& operator=(const ArmedGrip&) = delete;

  void live(Duration span) { run(emulator_, driver, now, now + span); }
  const HandTruth& truth() const noexcept { return hand_.truth(); }

  TimePoint now = kStart;

 private:
  static AxisWords counts(const Vec3& p_MH) {
    const auto n = counts_from_theta1(kFalconTable1, motor_angles(kFalconTable1, p_MH).theta1);
    return {static_cast<std::int16_t>(n[0]), static_cast<std::int16_t>(n[1]),
            static_cast<std::int16_t>(n[2])};
  }
  static DriverConfig paced_by_device(DriverConfig config) {
    config.pacing = Pacing::device;
    return config;
  }
  Mechanism mechanism() {
    return {.read =
                [this](TimePoint at) {
                  if (free_) return moving_.read(at);
                  return GripState{.counts = held_, .buttons = buttons_};
                },
            .drive =
                [this](TimePoint at, const AxisWords& motors) {
                  if (free_) moving_.drive(at, motors);
                }};
  }

  AxisWords held_;
  EmulatedHand hand_;
  Mechanism moving_;
  bool free_ = false;
  std::uint8_t buttons_ = 0;
  Emulator emulator_;

 public:
  Driver driver;
};

}  // namespace farhand::falcon_usb
