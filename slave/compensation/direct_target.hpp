// Direct feedback at the robot in six axes: it goes where the handle is thought to be, through gaps
// too (common/concealment.hpp). Translation and rotation are each under a guard
// (slave/compensation/velocity_guard.hpp), which brings the target back to the handle slowly after
// it had to hold it off.
#pragma once

#include <optional>

#include "common/concealment.hpp"
#include "common/guarded_port.hpp"
#include "slave/compensation/inputs.hpp"
#include "slave/compensation/velocity_guard.hpp"

namespace farhand {

struct DirectTargetConfig {
  double max_speed = 1, max_turn_rate = 6;  // of the target [m/s], [rad/s], in the handle's terms
  VelocityGuardConfig translation;
  std::optional<VelocityGuardConfig> rotation;  // nothing: the orientation stays
  ConcealmentConfig concealment;
};

class DirectTarget {
 public:
  explicit DirectTarget(const DirectTargetConfig& config) noexcept;

  // At rest in X_MT: when the robot begins to follow.
  void start(const Pose& X_MT) noexcept {
    X_MH_ = X_MT;
    X_MR_.reset();
  }
  // The target after this tick, as a handle pose. The caller limits its speed.
  Pose step(const TargetInputs& in) noexcept;
  // What the master must know, into the next message.
  void tell(SlaveToMaster& out) const noexcept;

 private:
  // What moves the target, the handle and the robot, in this tick or since the last one.
  struct Moves {
    Vec3 handle, stretch, robot;  // stretch: of the handle less the target, after its move
  };
  struct Port {
    explicit Port(const VelocityGuardConfig& config) noexcept : guard(config) {}
    // The target's move.
    Vec3 step(const Moves& moves, const Vec3& F_E, double peer_in) noexcept;

    VelocityGuard guard;
    PeerEnergy peer;
  };
  Pose reckon(const TargetInputs& in) const noexcept;
  Mat3 turn(const TargetInputs& in, const Mat3& R_MH) noexcept;

  DirectTargetConfig config_;
  Port translation_;
  std::optional<Port> rotation_;
  Pose X_MH_;                 // where the handle was thought to be in the last tick,
  std::optional<Pose> X_MR_;  // and the robot was
};

}  // namespace farhand
