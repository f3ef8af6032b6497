// The slave's guard: what moves the robot may give the environment no more energy than the master
// reported to have put in (common/energy_budget.hpp). The admittance form of the passivity
// controller, at the port (target's velocity, measured contact force), which costs nothing in free
// motion:
//
//   v' = v - beta F_e,   beta = (outflow of this tick - W) / (|F_e|^2 Ts), until no energy flows
//
// The target then lags behind the handle. Where the method has no spring of its own to bring it
// back, drift compensation does (Chawda and O'Malley 2014, Coelho et al. 2019):
// v_add = stretch / tau, limited, and only from a surplus of energy. Gaps as at the master's.
//
// A guard whose store is spent lets nothing through that could give energy; in free motion the
// noise of F_e would say what. So F_e counts by what it exceeds that, whichever way energy flows.
// What a robot gives to something that it slides along with less is not counted.
#pragma once

#include "common/energy_budget.hpp"
#include "common/geometry.hpp"

namespace farhand {

struct VelocityGuardConfig {
  double Ts = 0.001;
  double store = kEnergyStore;   // E0 [J]
  double drift_time = 0.05;      // tau [s]
  double drift_speed = 0.05;     // [m/s], [rad/s]
  double noise = 0;              // [N], [N m] of F_e that is none
  bool returns_surplus = false;  // see EnergyBudget
};

class VelocityGuard {
 public:
  explicit VelocityGuard(const VelocityGuardConfig& config) noexcept
      : config_(config), budget_(config.store, config.returns_surplus) {}

  // The target's velocity in this tick in place of v. stretch: handle, as received, less target;
  // zero without drift compensation. F_e: robot on environment.
  Vec3 step(const Vec3& v, const Vec3& stretch, const Vec3& F_e) noexcept;
  // The same for a robot that follows its target with a lag: the work counts that it did on the
  // environment, whatever the target did meanwhile. Target and force of a lagging robot would seem
  // to get energy out of a wall that gives none. moved: by the robot since the last tick.
  Vec3 step(const Vec3& v, const Vec3& stretch, const Vec3& F_e, const Vec3& moved) noexcept;

  const VelocityGuardConfig& config() const noexcept { return config_; }
  EnergyBudget& budget() noexcept { return budget_; }
  const EnergyBudget& budget() const noexcept { return budget_; }
  bool acting() const noexcept { return acting_; }

 private:
  Vec3 contact(const Vec3& F_e) const noexcept;
  Vec3 allowed(const Vec3& v, const Vec3& stretch, const Vec3& F_e) noexcept;
  Vec3 drift(const Vec3& v, const Vec3& stretch, const Vec3& F_e) const noexcept;

  VelocityGuardConfig config_;
  EnergyBudget budget_;
  bool acting_ = false;
};

}  // namespace farhand
