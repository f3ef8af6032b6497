// P+d's rotation at the robot (slave/compensation/damped.hpp): a virtual inertia in the tool's
// place, turned by a guarded spring to the handle's orientation.
#pragma once

#include "common/concealment.hpp"
#include "common/guarded_port.hpp"
#include "slave/compensation/damped.hpp"
#include "slave/compensation/inputs.hpp"

namespace farhand {

struct DampedTurnConfig {
  DampedConfig spring{.stiffness = 1, .max_damping = 0.02};
  VirtualMassConfig inertia{
      .mass = 0.002, .contact_damping = 0.05, .contact_force = 0.02, .max_speed = 6};
  ForceGuardConfig guard{.store = 0.005, .reserve = 0.001, .max_damping = 0.02, .max_speed = 20};
  ConcealmentConfig concealment;
};

class DampedTurn {
 public:
  explicit DampedTurn(const DampedTurnConfig& config) noexcept
      : config_(config), spring_(config.spring), port_(config.guard) {}

  // At rest in R_MT: when the robot begins to follow.
  void start(const Mat3& R_MT) noexcept;
  // The target's orientation after this tick.
  Mat3 step(const TargetInputs& in) noexcept;

  double told() const noexcept { return port_.told(); }  // see PortEnergies

 private:
  DampedTurnConfig config_;
  DampedSlave spring_;
  GuardedPort port_;
  Mat3 R_MT_ = Mat3::Identity();  // of the last tick
  Vec3 turned_ = Vec3::Zero();    // of the target, added up
};

}  // namespace farhand
