// Drives a Falcon's grip gently from place to place: the master's position control, in the hands of
// farhand-falcon's checks.
#pragma once

#include <optional>

#include "master/handle.hpp"
#include "master/haptic_device.hpp"
#include "master/position_control.hpp"

namespace farhand::falcon_usb {

class Hold {
 public:
  static constexpr double kMaxForce = 6;     // [N]
  static constexpr double kMaxSpeed = 0.06;  // [m/s]
  static constexpr double kLost = 0.03;      // [m]

  explicit Hold(const FalconGeometry& geometry);

  // From now on to there, in M.
  void go(const Vec3& p_MH);

  // Of a grip at rest: what holds it now is its weight, from the next go() on. Until then it is
  // taken to be the published one.
  void weigh();

  struct Step {
    Vec3 p_MH = Vec3::Zero();
    Vec6 tau = Vec6::Zero();  // to be written
    bool lost = false;  // the grip is kLost from where it is driven: held, or pushed the wrong way
  };
  // Once a millisecond. Nothing, and so zero torque, where the reading has no pose; lost also from
  // then on until go().
  std::optional<Step> step(TimePoint now, const HandleReading& reading);

 private:
  FalconHandle handle_;
  HandlePose pose_;
  HandleVelocity velocity_;
  std::optional<PositionControl> control_;
  Vec3 force_ = Vec3::Zero();                                        // last
  double weight_ = PositionControlConfig{}.gravity_mass * kGravity;  // [N]
  bool lost_ = false;
};

}  // namespace farhand::falcon_usb
