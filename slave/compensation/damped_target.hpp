// P+d at the robot (slave/compensation/damped.hpp) in six axes: where the virtual mass stands is
// where the robot is told to go. All of it in the handle's terms, so that stiffness, mass and
// energy mean the same on both sides whatever the scales are.
#pragma once

#include "common/concealment.hpp"
#include "common/guarded_port.hpp"
#include "common/ports.hpp"
#include "common/wire.hpp"
#include "slave/compensation/damped.hpp"

namespace farhand {

struct DampedTargetConfig {
  bool rotation = true;  // false: the orientation stays
  DampedConfig translation;
  DampedConfig turn{.stiffness = 1, .max_damping = 0.02};
  VirtualMassConfig mass;
  VirtualMassConfig inertia{
      .mass = 0.002, .contact_damping = 0.05, .contact_force = 0.02, .max_speed = 6};
  ForceGuardConfig guard;
  ForceGuardConfig rotation_guard{.store = 0.005, .reserve = 0.001, .max_damping = 0.02};
  ConcealmentConfig concealment;
};

class DampedTarget {
 public:
  explicit DampedTarget(const DampedTargetConfig& config) noexcept;

  // At rest in X_MT, the target as a handle pose: when the robot begins to follow.
  void start(const Pose& X_MT) noexcept;
  // The target after this tick. X_MT: where it is, whoever limited it since the last. F_E_M: robot
  // on environment.
  Pose step(const Pose& X_MT, const MasterToSlave& handle, Duration age, Duration echo_age,
            const Wrench& F_E_M) noexcept;

  PortEnergies told() const noexcept { return {translation_.told(), rotation_.told()}; }

 private:
  DampedTargetConfig config_;
  DampedSlave spring_, turn_;
  GuardedPort translation_, rotation_;
  Pose X_MT_;                   // of the last tick
  Vec3 turned_ = Vec3::Zero();  // of the target, added up
};

}  // namespace farhand
