// P+d at the robot (slave/compensation/damped.hpp) in six axes: where the virtual mass stands is
// where the robot is told to go.
#pragma once

#include <optional>

#include "common/concealment.hpp"
#include "common/guarded_port.hpp"
#include "slave/compensation/damped.hpp"
#include "slave/compensation/damped_turn.hpp"
#include "slave/compensation/inputs.hpp"

namespace farhand {

struct DampedTargetConfig {
  DampedConfig translation;
  VirtualMassConfig mass;
  ForceGuardConfig guard;
  ConcealmentConfig concealment;
  std::optional<DampedTurnConfig> rotation;  // nothing: the orientation stays
};

class DampedTarget {
 public:
  explicit DampedTarget(const DampedTargetConfig& config) noexcept;

  // At rest in X_MT: when the robot begins to follow.
  void start(const Pose& X_MT) noexcept;
  // Another method will be at work: of what the guard has in hand only its store is kept.
  void change_over() noexcept { translation_.cap(); }
  // The target after this tick, as a handle pose.
  Pose step(const TargetInputs& in) noexcept;
  // What the master must know, into the next message.
  void tell(SlaveToMaster& out) const noexcept;

 private:
  DampedTargetConfig config_;
  DampedSlave spring_;
  GuardedPort translation_;
  std::optional<DampedTurn> rotation_;
  Vec3 p_MT_ = Vec3::Zero();  // of the last tick
};

}  // namespace farhand
