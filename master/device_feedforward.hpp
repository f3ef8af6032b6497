// What the handle's own dynamics would make the hand feel, given by the motors instead (reference
// section 9.4):
//
//   F = -g weight + b B v + f F_k tanh(|w| / v_k) w/|w| + m M a,    w = v + lead a
//
// with a share of each. The lead makes up for the delay between measuring and pushing where
// friction turns round. Shares below 1 leave room for a model that is wrong.
#pragma once

#include "master/device_observer.hpp"

namespace farhand {

struct DeviceFeedforwardConfig {
  double gravity = 1;
  double damping = 0.9;
  double friction = 0.9;
  double inertia = 0.8;
  double rotation_inertia = 0.4;  // behind tilt and twist stands no mass of the hand
  double friction_lead = 0.0025;  // [s]
};

class DeviceFeedforward {
 public:
  DeviceFeedforward(const DeviceFeedforwardConfig& config, const DeviceModel& model) noexcept;
  // Load of the motors on the handle.
  DeviceAxes step(const DeviceMotion& motion) const noexcept;

 private:
  DeviceModel friction_;          // nothing but friction, times its share
  DeviceAxes damping_, inertia_;  // times their shares
  Vec3 lift_M_;
  double lead_;
};

}  // namespace farhand
