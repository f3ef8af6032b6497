// Direct feedback at the handle in six axes: the contact force and torque as they come, each under
// a guard of its own (common/force_guard.hpp). In a gap they are held and fade. Costs: it rings
// from a round trip of B_h / ke on; the guard then takes the force away.
#pragma once

#include <optional>

#include "common/guarded_port.hpp"
#include "master/compensation.hpp"
#include "master/compensation/inputs.hpp"

namespace farhand {

struct DirectCouplingConfig {
  double max_force = 20;  // [N] that the hand may feel: the guard must see it,
  double max_torque = 1;  // [N m] too
  ForceGuardConfig translation;
  std::optional<ForceGuardConfig> rotation;  // nothing: no torque
};

class DirectCoupling {
 public:
  explicit DirectCoupling(const DirectCouplingConfig& config) noexcept;

  // Handle on coupling, G axes.
  Wrench step(const CouplingInputs& in) noexcept;
  // In a tick in which nothing of it is felt.
  void let_go() noexcept;
  // What the slave must know, into the next message.
  void tell(MasterToSlave& out) const noexcept;

 private:
  double max_force_, max_torque_, Ts_;
  FadeIn fade_in_;
  GuardedPort translation_;
  std::optional<GuardedPort> rotation_;
  std::optional<Mat3> R_;       // of the last tick
  Vec3 turned_ = Vec3::Zero();  // of the handle in M axes, added up
};

}  // namespace farhand
