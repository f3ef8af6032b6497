// What acts on the handle and no model explains, from the observer's unexplained load through one
// pole. With a force sensor it is the error of the model, and the motors take a share of it away.
// Without one (a Falcon) it is the user's force and the error of the model together: an estimate
// of the user, no better than the model.
#pragma once

#include "common/pid.hpp"
#include "master/device_observer.hpp"

namespace farhand {

struct DisturbanceObserverConfig {
  double share = 0.5;     // taken away by the motors; 0 where it is the estimate of the user
  double cutoff_hz = 10;  // 0: none. Delays by 1 / (2 pi fc) beyond the observer's own 3 poles
};

class DisturbanceObserver {
 public:
  DisturbanceObserver(const DisturbanceObserverConfig& config, double Ts) noexcept
      : share_(config.share), gain_(low_pass_gain(config.cutoff_hz, Ts)) {}

  // Once per tick: the load on the handle that is not explained.
  const DeviceAxes& step(const DeviceMotion& motion) noexcept {
    rest_ += gain_ * (motion.rest - rest_);
    return rest_;
  }
  // Of the motors, against it.
  DeviceAxes against() const noexcept { return -share_ * rest_; }

 private:
  double share_, gain_;
  DeviceAxes rest_ = DeviceAxes::Zero();
};

}  // namespace farhand
