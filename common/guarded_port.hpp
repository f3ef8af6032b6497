// A side's guard of one port, and the sums that the messages carry between the two.
#pragma once

#include <optional>

#include "common/force_guard.hpp"

namespace farhand {

// The peer's `in`, of its newest message. What it counted before we first heard it was another's to
// give out; less than before means that it began anew.
class PeerEnergy {
 public:
  void hear(double peer_in, EnergyBudget& budget) noexcept {
    if (heard_ && peer_in < *heard_) budget.restart();
    if (!heard_ || peer_in < *heard_) before_ = peer_in;
    heard_ = peer_in;
    budget.receive(peer_in - before_);
  }

 private:
  std::optional<double> heard_;
  double before_ = 0;
};

class GuardedPort {
 public:
  explicit GuardedPort(const ForceGuardConfig& config) noexcept : guard_(config) {}

  void hear(double peer_in) noexcept { peer_.hear(peer_in, guard_.budget()); }
  double told() const noexcept { return guard_.budget().in(); }

  Vec3 step(const Vec3& F_wanted, const Vec3& x) noexcept { return guard_.step(F_wanted, x); }
  void let_go() noexcept { guard_.let_go(); }
  void cap() noexcept { guard_.budget().cap(); }
  double left() const noexcept { return guard_.budget().left(); }

 private:
  ForceGuard guard_;
  PeerEnergy peer_;
};

}  // namespace farhand
