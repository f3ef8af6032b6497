// The Smith predictor at the handle (master/compensation/smith.hpp): of translation, robot and
// registered wall are computed here, under a guard around the operator's port alone, which keeps no
// more of the hand's work than kOperatorCap; rotation is P+d. The slave tells where the wall is in
// the handle's terms and which pose its force answers.
#pragma once

#include <optional>

#include "common/force_guard.hpp"
#include "master/compensation/damped_rotation.hpp"
#include "master/compensation/inputs.hpp"
#include "master/compensation/smith.hpp"

namespace farhand {

struct SmithCouplingConfig {
  SmithConfig model;      // its wall comes with the messages
  double max_force = 20;  // [N] that the hand may feel: the guard must see it
  ForceGuardConfig guard;
  std::optional<DampedRotationConfig> rotation;  // nothing: no torque
};

class SmithCoupling {
 public:
  explicit SmithCoupling(const SmithCouplingConfig& config) noexcept;

  // Handle on coupling, G axes. A message without a wall, or without the stamp of the pose that it
  // answers, gives the contact force as it is.
  Wrench step(const CouplingInputs& in) noexcept;
  // In a tick in which nothing of it is felt.
  void let_go() noexcept;
  // What the slave must know, into the next message.
  void tell(MasterToSlave& out) const noexcept;

 private:
  SmithPredictor predictor_;
  double max_force_, Ts_;
  FadeIn fade_in_;
  ForceGuard guard_;
  std::optional<DampedRotation> rotation_;
};

}  // namespace farhand
