// P+d at the handle (common/damped.hpp) in six axes: translation is one port, rotation another,
// each under a guard of its own (common/force_guard.hpp). Takes the place of the contact force that
// is reflected without compensation.
#pragma once

#include <optional>

#include "common/damped.hpp"
#include "common/guarded_port.hpp"
#include "master/compensation/damped.hpp"
#include "master/compensation/damped_rotation.hpp"
#include "master/compensation/inputs.hpp"

namespace farhand {

struct DampedCouplingConfig {
  DampedConfig translation;
  double max_force = 20;  // [N] that the hand may feel: the guard must see it
  ForceGuardConfig guard;
  std::optional<DampedRotationConfig> rotation;  // nothing: no torque
};

class DampedCoupling {
 public:
  explicit DampedCoupling(const DampedCouplingConfig& config) noexcept;

  // Handle on coupling, G axes. Without the robot's pose in the message only the dampers act.
  Wrench step(const CouplingInputs& in) noexcept;
  // In a tick in which nothing of it is felt.
  void let_go() noexcept;
  // Another method was or will be at work: of what the guard has in hand only its store is kept.
  void change_over() noexcept;
  // What the slave must know, into the next message.
  void tell(MasterToSlave& out) const noexcept;

 private:
  DampedMaster spring_;
  double max_force_;
  double Ts_;
  FadeIn fade_in_;
  GuardedPort translation_;
  std::optional<DampedRotation> rotation_;
};

}  // namespace farhand
