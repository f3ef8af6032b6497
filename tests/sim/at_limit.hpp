// Whether something holds the robot back, by what can be seen from outside: a command that is off
// its target or off what was asked for, a target or a joint that is asked for about its speed, a
// drive at its torque.
#pragma once

#include "tests/loop/loopback.hpp"

namespace farhand {

class AtLimit {
 public:
  explicit AtLimit(const Loopback& loop) noexcept : loop_(loop) {}

  // Every tick that is coupled; q: where the robot truly is.
  bool step(const SlaveTick& tick, const Vec6& q) noexcept;
  // In others.
  void reset() noexcept { last_.reset(); }

 private:
  bool off_target(const SlaveTick& tick) const noexcept;
  bool joints_at_limit(const SlaveTick& tick, const Vec6& q) const noexcept;

  struct Last {
    Vec6 q_cmd;
    Pose X_SE_target;
  };
  const Loopback& loop_;
  std::optional<Last> last_;
  Vec6 dq_cmd_ = Vec6::Zero();
};

}  // namespace farhand
