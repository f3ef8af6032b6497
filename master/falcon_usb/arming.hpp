// The gesture that lets torque through: some buttons held together for a while, after they were
// seen not to be.
#pragma once

#include <cstdint>
#include <optional>

#include "common/time.hpp"
#include "master/falcon_usb/packet.hpp"

namespace farhand::falcon_usb {

struct ArmingConfig {
  std::uint8_t buttons = kButtonCentre | kButtonForward;  // all of them; not none
  Duration hold = std::chrono::milliseconds(500);
};

class Arming {
 public:
  explicit Arming(const ArmingConfig& config) noexcept : config_(config) {}

  void forget() noexcept { released_ = false, since_.reset(); }
  // True once the gesture is complete.
  bool step(std::uint8_t buttons, TimePoint now) noexcept {
    if ((buttons & config_.buttons) != config_.buttons) {
      released_ = true;
      since_.reset();
    } else if (released_ && !since_) {
      since_ = now;
    }
    return since_ && now - *since_ >= config_.hold;
  }

 private:
  ArmingConfig config_;
  bool released_ = false;
  std::optional<TimePoint> since_;
};

}  // namespace farhand::falcon_usb
