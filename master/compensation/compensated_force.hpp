// The method that a scene names, at the handle. A closed variant; another method is one more entry
// with the same members.
#pragma once

#include <variant>

#include "common/peer.hpp"
#include "master/compensation.hpp"
#include "master/compensation/chosen_coupling.hpp"
#include "master/compensation/damped_coupling.hpp"
#include "master/compensation/direct_coupling.hpp"
#include "master/compensation/mediated_coupling.hpp"
#include "master/compensation/smith_coupling.hpp"
#include "master/compensation/wave_coupling.hpp"

namespace farhand {

using CompensatedForceConfig =
    std::variant<DampedCouplingConfig, MediatedCouplingConfig, ChosenCouplingConfig,
                 DirectCouplingConfig, WaveCouplingConfig, SmithCouplingConfig>;

class CompensatedForce {
 public:
  explicit CompensatedForce(const CompensatedForceConfig& config) noexcept
      : method_(std::visit([](const auto& c) { return made(c); }, config)) {}

  // In every tick with a message, its newest, also while nothing is coupled.
  void hear(const Peer<SlaveToMaster>& slave, TimePoint now) noexcept {
    if (auto* wave = std::get_if<WaveCoupling>(&method_)) wave->hear(slave, now);
  }
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
  // The contact force itself is felt, which in a gap may be held for less long than a spring.
  bool reflects() const noexcept {
    return std::holds_alternative<DirectCoupling>(method_) ||
           std::holds_alternative<SmithCoupling>(method_);
  }

 private:
  using Methods = std::variant<DampedCoupling, MediatedCoupling, ChosenCoupling, DirectCoupling,
                               WaveCoupling, SmithCoupling>;
  static Methods made(const DampedCouplingConfig& c) noexcept { return DampedCoupling(c); }
  static Methods made(const MediatedCouplingConfig& c) noexcept { return MediatedCoupling(c); }
  static Methods made(const ChosenCouplingConfig& c) noexcept { return ChosenCoupling(c); }
  static Methods made(const DirectCouplingConfig& c) noexcept { return DirectCoupling(c); }
  static Methods made(const WaveCouplingConfig& c) noexcept { return WaveCoupling(c); }
  static Methods made(const SmithCouplingConfig& c) noexcept { return SmithCoupling(c); }

  Methods method_;
};

}  // namespace farhand
