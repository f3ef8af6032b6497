// P+d's rotation at the handle (common/damped.hpp), one port under a guard of its own
// (common/force_guard.hpp). Tilt and twist have stiffnesses of their own, since the twist's motors
// can render less.
#pragma once

#include "common/damped.hpp"
#include "common/guarded_port.hpp"
#include "master/compensation/damped.hpp"
#include "master/compensation/inputs.hpp"

namespace farhand {

struct DampedRotationConfig {
  DampedConfig tilt{.stiffness = 1, .max_damping = 0.02};
  DampedConfig twist{.stiffness = 0.2, .max_damping = 0.003};
  double max_torque = 1;  // [N m] that the hand may feel: the guard must see it
  ForceGuardConfig guard{.store = 0.005, .reserve = 0.001, .max_damping = 0.02, .max_speed = 20};
};

class DampedRotation {
 public:
  explicit DampedRotation(const DampedRotationConfig& config) noexcept;

  // Torque of the handle on the coupling, G axes. Without the robot's pose in the message only the
  // dampers act.
  Vec3 step(const CouplingInputs& in, double share) noexcept;
  // In a tick in which nothing of it is felt.
  void let_go() noexcept;

  double told() const noexcept { return port_.told(); }  // see PortEnergies

 private:
  Vec3 wanted(const CouplingInputs& in) noexcept;

  DampedMaster tilt_, twist_;
  double max_torque_;
  GuardedPort port_;
  bool turning_ = false;
  Mat3 R_ = Mat3::Identity();
  Vec3 turned_ = Vec3::Zero();  // of the handle in M axes, added up
};

}  // namespace farhand
