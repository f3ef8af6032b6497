// The driver and an emulated Falcon, with a loop that writes the same torque every millisecond.
#pragma once

#include "master/falcon_usb/driver.hpp"
#include "tests/falcon_usb/emulated_falcon.hpp"

namespace farhand::falcon_usb {

inline constexpr std::uint8_t kGesture = kButtonCentre | kButtonForward;

struct Rig {
  explicit Rig(const EmulatorConfig& config = {.processor = {.firmware_loaded = true}},
               const DriverConfig& driver_config = {})
      : emulator(config, grip.mechanism()), driver(driver_config) {
    emulator.plug(now);
  }
  void live(Duration span) {
    for (const TimePoint end = now + span; now < end;) {
      driver.write(now, tau);
      run(emulator, driver, now, std::min(now + 1ms, end));
    }
  }
  // At most a minute; whether it got there.
  bool live_until(Phase phase) {
    for (int i = 0; i < 60000 && this->phase() != phase; ++i) live(1ms);
    return this->phase() == phase;
  }
  // Homes and makes the gesture.
  bool arm() {
    grip.buttons = 0;
    if (!live_until(Phase::homed)) return false;
    live(10ms);
    grip.buttons = kGesture;
    live_until(Phase::armed);
    grip.buttons = 0;
    live(50ms);
    return phase() == Phase::armed;
  }
  Phase phase() const { return driver.status().phase; }
  Trouble trouble() const { return driver.status().trouble; }
  bool drives() const { return grip.driven != AxisWords{}; }

  ScriptedGrip grip;
  TimePoint now = kStart;
  Vec6 tau = (Vec6() << 0.1, -0.2, 0.3, 0, 0, 0).finished();
  Emulator emulator;
  Driver driver;
};

}  // namespace farhand::falcon_usb
