// The guard where a side exerts a force: it may give out no more energy than the peer reported to
// have put in (common/energy_budget.hpp). At the master against the hand, at a slave with a virtual
// mass against that. The impedance form of the passivity controller (Ryu et al. 2010): damping, as
// much as is lacking,
//
//   F' = F + alpha v,   alpha = (outflow of this tick - W) / (|v|^2 Ts)
//
// first until the force no longer drives the hand, then up to max_damping until what leaked is
// paid back. Work is taken from the encoder, F(n-1) (x(n) - x(n-1)), since a filtered velocity
// misses what a fast reversal does, and v is foreseen from the last two steps. What a reversal
// still leaks comes out of a reserve, and as that runs down, the whole force goes to zero with it.
//
// Energy that the hand itself stored in a spring here counts as coming from the network, so a large
// spring comes back damped where the store is small against it. A method that
// renders a model at the master gives energy that no message announced: for it the guard is closed
// around the operator's port alone, where the budget receives its own `in`. Gaps: a lost message is
// only late energy; while none comes W runs down, and the hand is driven no more.
#pragma once

#include "common/energy_budget.hpp"
#include "common/geometry.hpp"

namespace farhand {

struct ForceGuardConfig {
  double Ts = 0.001;
  double store = kEnergyStore;   // E0 [J]
  double reserve = 0.005;        // [J] of it, for what a tick does not foresee; > 0
  double max_damping = 50;       // [N s/m], [N m s] beyond what stops the outflow: the device's
  double max_speed = 5;          // [m/s], [rad/s]: a step beyond it is a wrong reading and no work
  bool returns_surplus = false;  // see EnergyBudget
};

class ForceGuard {
 public:
  explicit ForceGuard(const ForceGuardConfig& config) noexcept
      : config_(config), budget_(config.store - config.reserve, config.returns_surplus) {}

  // F_wished resists: handle on coupling, or mass on coupling. x: where the handle or mass is, by
  // which the last force did its work. Returns the force to give in place of F_wished. All of the
  // port's force must pass here, dampers included. One that is not finite is none.
  Vec3 step(const Vec3& F_wished, const Vec3& x) noexcept;
  // Not driven by us since the last step: no work is counted, and the next step starts anew.
  void let_go() noexcept {
    F_ = added_ = Vec3::Zero();
    ticks_ = 0;
  }

  EnergyBudget& budget() noexcept { return budget_; }
  const EnergyBudget& budget() const noexcept { return budget_; }
  bool acting() const noexcept { return acting_; }

 private:
  ForceGuardConfig config_;
  EnergyBudget budget_;
  int ticks_ = 0;  // that x_ and moved_ are known for, up to 2
  bool acting_ = false;
  Vec3 x_ = Vec3::Zero(), moved_ = Vec3::Zero();
  Vec3 F_ = Vec3::Zero(), added_ = Vec3::Zero();
};

}  // namespace farhand
