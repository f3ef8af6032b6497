// Damping that is there only in contact (reference section 9.4). A handle whose own damping was
// hidden from the hand loses stiff walls over a slow network; this gives it back while the
// environment pushes, and fades so that free motion stays free.
#pragma once

#include <algorithm>

#include "master/device_observer.hpp"

namespace farhand {

struct ContactDampingConfig {
  double translation = 15;  // [N s/m]
  double tilt = 0.02;       // [N m s]
  double twist = 2e-3;      // [N m s]
  double force = 0.3;       // [N] of the environment: contact
  double torque = 0.02;     // [N m] likewise
  double fade_time = 0.05;  // [s] > 0, from none to all and back
};

class ContactDamping {
 public:
  ContactDamping(const ContactDampingConfig& config, double Ts) noexcept
      : config_(config),
        damping_(per_axis(config.translation, config.tilt, config.twist)),
        step_(std::min(1.0, Ts / config.fade_time)) {}

  // What the environment's load is to be raised by at the handle's velocity.
  DeviceAxes step(const Wrench& F_env_G, const DeviceAxes& v) noexcept {
    const bool touching = F_env_G.force.squaredNorm() > config_.force * config_.force ||
                          F_env_G.torque.squaredNorm() > config_.torque * config_.torque;
    share_ = std::clamp(share_ + (touching ? step_ : -step_), 0.0, 1.0);
    return share_ * damping_ * v;
  }

 private:
  ContactDampingConfig config_;
  DeviceAxes damping_;
  double step_;
  double share_ = 0;
};

}  // namespace farhand
