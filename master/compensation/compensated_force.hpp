// The method that a scene names, at the handle. A closed variant; another method is one more entry
// with the same members.
#pragma once

#include <variant>

#include "master/compensation/chosen_coupling.hpp"
#include "master/compensation/damped_coupling.hpp"
#include "master/compensation/mediated_coupling.hpp"

namespace farhand {

using CompensatedForceConfig =
    std::variant<DampedCouplingConfig, MediatedCouplingConfig, ChosenCouplingConfig>;

class CompensatedForce {
 public:
  explicit CompensatedForce(const CompensatedForceConfig& config) noexcept
      : method_(std::visit([](const auto& c) { return made(c); }, config)) {}

  // Handle on coupling, G axes: in place of the contact force reflected as it comes.
  Wrench step(const CouplingInputs& in) noexcept {
    return std::visit([&](auto& m) { return m.step(in); }, method_);
  }
  // In a tick in which nothing of it is felt.
  void let_go() noexcept {
    std::visit([](auto& m) { m.let_go(); }, method_);
  }
  // What the slave must know, into the next message.
  void tell(MasterToSlave& out) const noexcept {
    std::visit([&](const auto& m) { m.tell(out); }, method_);
  }
  // Why the present method; nullptr where the scene named it.
  const MethodChoice* choice() const noexcept {
    const auto* chosen = std::get_if<ChosenCoupling>(&method_);
    return chosen != nullptr ? &chosen->choice() : nullptr;
  }

 private:
  using Methods = std::variant<DampedCoupling, MediatedCoupling, ChosenCoupling>;
  static Methods made(const DampedCouplingConfig& c) noexcept { return DampedCoupling(c); }
  static Methods made(const MediatedCouplingConfig& c) noexcept { return MediatedCoupling(c); }
  static Methods made(const ChosenCouplingConfig& c) noexcept { return ChosenCoupling(c); }

  Methods method_;
};

}  // namespace farhand
