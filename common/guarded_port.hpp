// A side's guard of one port, and the sums that the messages carry between the two.
#pragma once

#include "common/force_guard.hpp"

namespace farhand {

class GuardedPort {
 public:
  explicit GuardedPort(const ForceGuardConfig& config) noexcept : guard_(config) {}

  // The peer's `in`, of its newest message. Less than before: it began anew.
  void hear(double peer_in) noexcept {
    if (peer_in < heard_) guard_.budget().restart();
    heard_ = peer_in;
    guard_.budget().receive(peer_in);
  }
  double told() const noexcept { return guard_.budget().in(); }

  Vec3 step(const Vec3& F_wanted, const Vec3& x) noexcept { return guard_.step(F_wanted, x); }
  void let_go() noexcept { guard_.let_go(); }
  bool acting() const noexcept { return guard_.acting(); }
  double left() const noexcept { return guard_.budget().left(); }

 private:
  ForceGuard guard_;
  double heard_ = 0;
};

}  // namespace farhand
