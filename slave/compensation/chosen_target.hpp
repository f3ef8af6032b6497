// `auto` at the robot: the target follows by the method that the master's message names. What the
// robot touches is watched with all of them, so that the master knows when there is a wall to be
// rendered; rotation is P+d with all of them.
#pragma once

#include <optional>

#include "slave/compensation/damped_target.hpp"
#include "slave/compensation/mediated_target.hpp"

namespace farhand {

struct ChosenTargetConfig {
  DampedTargetConfig damped;  // both without rotation
  MediatedTargetConfig mediated;
  std::optional<DampedTurnConfig> rotation;  // nothing: the orientation stays
};

class ChosenTarget {
 public:
  explicit ChosenTarget(const ChosenTargetConfig& config) noexcept;

  // At rest in X_MT: when the robot begins to follow.
  void start(const Pose& X_MT) noexcept;
  // The target after this tick, as a handle pose. The caller limits its speed. A method that is
  // none of these is `direct`.
  Pose step(const TargetInputs& in) noexcept;
  // What the master must know, into the next message.
  void tell(SlaveToMaster& out) const noexcept;

 private:
  DampedTarget damped_;
  MediatedTarget mediated_;
  ConcealmentConfig concealment_;
  std::optional<DampedTurn> rotation_;
  Method method_ = Method::direct;  // of the last tick
};

}  // namespace farhand
