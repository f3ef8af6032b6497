// Velocity, acceleration and unexplained load of the handle, from its measured pose and what is
// known to act on it. Two third-order observers side by side, each with one triple pole
// p = exp(-2 pi f Ts) (gains of a fading-memory filter: 1 - p^3, 3/2 (1 - p)^2 (1 + p), (1 - p)^3):
//
//   on the model      x, v, d    m v' = F_u + F_m - drag(v) v + weight + d,  d' = 0
//   on the pose only  x, v, a    a' = 0
//
// v comes from the first: what acts is known before it moves anything, so v hardly lags (d is the
// load the model does not explain). a comes from the second: taken from the first it would feed
// the motors' own command back. Delay of a at low frequency: 3 / (2 pi f), 24 ms at 20 Hz.
#pragma once

#include "master/device_model.hpp"

namespace farhand {

struct DeviceObserverConfig {
  double velocity_hz = 25;      // > 0
  double acceleration_hz = 20;  // > 0
};

// Of one third-order observer with a triple pole at hz: of the place, and per second, and per
// second squared.
struct ObserverGains {
  double x, v, a;
};
ObserverGains observer_gains(double hz, double Ts) noexcept;

struct DeviceMotion {
  DeviceAxes v = DeviceAxes::Zero();
  DeviceAxes a = DeviceAxes::Zero();
  DeviceAxes rest = DeviceAxes::Zero();  // load the model does not explain
};

class DeviceObserver {
 public:
  DeviceObserver(const DeviceModel& model, const DeviceObserverConfig& config, double Ts) noexcept;

  // pose: measured now. known: F_u + F_m over the period that ends now, as far as it is known.
  // The first pose is at rest.
  const DeviceMotion& step(const HandlePose& pose, const DeviceAxes& known) noexcept;
  void reset() noexcept { primed_ = false; }

  const DeviceMotion& motion() const noexcept { return motion_; }

 private:
  DeviceAxes moved(const HandlePose& pose) noexcept;

  DeviceModel model_;
  DeviceAxes inertia_;
  double Ts_;
  ObserverGains on_model_, on_pose_;
  bool primed_ = false;
  HandlePose last_;
  DeviceAxes off_model_;          // measured place less the model's
  DeviceAxes off_pose_, v_pose_;  // the same of the other observer, and its velocity
  DeviceMotion motion_;
};

}  // namespace farhand
