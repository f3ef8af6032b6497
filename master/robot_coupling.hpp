// A spring and damper between the handle and the robot's pose as a handle pose: what the hand feels
// where the slave sends its position instead of its contact force, or beside it (the position
// channel of a bilateral architecture). Between them the robot's servo, the network's delay and the
// environment are felt through this one compliance.
#pragma once

#include "common/geometry.hpp"
#include "common/wire.hpp"
#include "master/handle.hpp"

namespace farhand {

struct RobotCouplingConfig {
  double stiffness = 500;         // [N/m]
  double damping = 5;             // [N s/m]
  double rotation_stiffness = 2;  // [N m/rad], both tilts
  double rotation_damping = 0.02;
  double twist_stiffness = 0.3;  // [N m/rad], about the handle's axis
  double twist_damping = 0.003;
};

// The wrench the handle exerts on the coupling, at H in handle axes: as if the robot's
// environment, so that it takes F_env's place or is added to it. From the handle's pose and
// velocity V_MH to those that mean where the robot is; zero if the slave does not send them.
Wrench couple(const RobotCouplingConfig& config, const HandlePose& handle, const Twist& V_MH,
              const SlaveToMaster& robot) noexcept;

}  // namespace farhand
