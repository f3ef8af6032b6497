// The guard where the hand is: what it gets in all is no more than it gave before, plus E0. For
// methods that render a model, which no guard between two ports of a network fits (the model gives
// energy that no message announced).
//
// The tank holds what the hand's work filled it with, F(n-1) (x(n) - x(n-1)), drag included, up to
// a cap, so that hours of drag do not pay for a shove. A wall that moves may do work on the hand:
// what the slave says the wall gave it in this contact is a credit on top.
#pragma once

#include <algorithm>
#include <cstdint>

#include "common/energy_budget.hpp"
#include "common/geometry.hpp"

namespace farhand {

inline constexpr double kOperatorCap = 0.2;  // [J]

// What the hand may be given now.
struct OperatorAllowance {
  double share = 1;   // 1 to 0, of a force that drives the hand
  double energy = 0;  // [J] until that share is less than 1
};

struct OperatorTankConfig {
  double start = kEnergyStore;  // E0 [J]
  double cap = kOperatorCap;    // [J]
  double reserve = 0.005;       // [J] of E0, for the tick in which the hand turns round
  double low = 0.01;            // [J] below, less the reserve, what drives the hand is scaled down
};

class OperatorTank {
 public:
  explicit OperatorTank(const OperatorTankConfig& config) noexcept
      : config_(config), held_(config.start) {}

  // Once per tick, before the force is given. F: handle on coupling in the last tick; x_m: where
  // the handle is now. net [J] and contact as the slave told (LocalWall).
  OperatorAllowance step(const Vec3& F, const Vec3& x_m, double net,
                         std::uint32_t contact) noexcept {
    if (contact != contact_) settle();
    contact_ = contact, credit_ = std::max(net, 0.0);
    if (started_) held_ = std::min(held_ + F.dot(x_m - x_m_), config_.cap);
    started_ = true, x_m_ = x_m;
    const double left = std::max(held_ + credit_ - config_.reserve, 0.0);
    return {std::min(left / config_.low, 1.0), std::max(left - config_.low, 0.0)};
  }
  double held() const noexcept { return held_; }

 private:
  // What the ended contact paid for is not owed any more.
  void settle() noexcept {
    if (held_ < 0) held_ = std::min(0.0, held_ + credit_);
  }

  OperatorTankConfig config_;
  double held_, credit_ = 0;
  std::uint32_t contact_ = 0;
  bool started_ = false;
  Vec3 x_m_ = Vec3::Zero();
};

}  // namespace farhand
