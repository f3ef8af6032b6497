// `auto` at the handle: the method is chosen by delay and by what the slave knows
// (common/method_choice.hpp), told to the slave, and taken up without a jump of the force.
// Direct feedback and the rendered wall are under one operator's tank, which also tells when direct
// feedback rings.
// Translation alone changes its method; rotation is P+d with all of them.
#pragma once

#include <optional>

#include "common/echo_delay.hpp"
#include "common/method_choice.hpp"
#include "master/compensation/damped_coupling.hpp"
#include "master/compensation/mediated_coupling.hpp"

namespace farhand {

struct ChosenCouplingConfig {
  MethodChoiceConfig choice;
  EchoDelayConfig delay;
  DampedCouplingConfig damped;  // both without rotation
  MediatedCouplingConfig mediated;
  std::optional<DampedRotationConfig> rotation;
};

class ChosenCoupling {
 public:
  explicit ChosenCoupling(const ChosenCouplingConfig& config) noexcept;

  // Handle on coupling, G axes.
  Wrench step(const CouplingInputs& in) noexcept;
  // In a tick in which nothing of it is felt.
  void let_go() noexcept;
  // What the slave must know, into the next message.
  void tell(MasterToSlave& out) const noexcept;

  const MethodChoice& choice() const noexcept { return choice_; }

 private:
  void choose(const CouplingInputs& in) noexcept;
  Wrench force(const CouplingInputs& in, const OperatorAllowance& allowed) noexcept;
  Wrench direct(const CouplingInputs& in, const OperatorAllowance& allowed) noexcept;

  double Ts_;
  EchoDelay delay_;
  MethodChooser chooser_;
  MethodChoice choice_;
  MethodBlend blend_;
  DampedCoupling damped_;
  MediatedCoupling mediated_;
  OperatorTank tank_;  // of the operator's port, for all that is given
  double max_force_;
  bool ringing_ = false;
  FadeIn fade_in_;
  std::optional<DampedRotation> rotation_;
  Vec3 F_M_ = Vec3::Zero();  // of the last tick
};

}  // namespace farhand
