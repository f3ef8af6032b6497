// A Falcon on this machine's USB as a haptic device. A thread of its own waits for the bus and
// keeps the device asked; the loop takes the newest reading and leaves the newest torque, both
// without waiting. The device is the clock of that exchange: a torque leaves with the next
// question, within a millisecond.
#pragma once

#include <cstddef>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "master/falcon_usb/driver.hpp"
#include "master/haptic_device.hpp"

namespace farhand {

struct FalconUsbConfig {
  falcon_usb::DriverConfig driver;  // its pacing and firmware are set here
  std::vector<std::byte> firmware;  // empty: only a device that already runs
  std::string serial;               // empty: any
};

// Copies share the device.
class FalconUsb {
 public:
  static constexpr bool kReal = true;

  // Throws a sentence if this machine has no USB. A device need not be there yet.
  explicit FalconUsb(FalconUsbConfig config);

  // As HapticDevice says. Not ok until the device is homed, and when nothing new has come for
  // `driver.stale`.
  HandleReading read(TimePoint now) noexcept;
  void write(TimePoint now, const Vec6& tau) noexcept;

  // For one thread, which need not be the loop's: what the user is to do now, if that has changed.
  std::optional<std::string> advice();

 private:
  class Shell;
  std::shared_ptr<Shell> shell_;  // the last one to go sends zero torque and ends the thread
};

static_assert(HapticDevice<FalconUsb>);

}  // namespace farhand
