// The model-mediated method at the robot in six axes (slave/compensation/local_wall.hpp): the tool
// follows the handle, held back where it would press too hard, and the wall that it touches is
// told. The orientation follows by P+d.
#pragma once

#include <optional>

#include "common/concealment.hpp"
#include "slave/compensation/damped_turn.hpp"
#include "slave/compensation/inputs.hpp"
#include "slave/compensation/local_wall.hpp"

namespace farhand {

struct MediatedTargetConfig {
  WallFinderConfig finder;
  ConcealmentConfig concealment;
  std::optional<DampedTurnConfig> rotation;  // nothing: the orientation stays
};

class MediatedTarget {
 public:
  explicit MediatedTarget(const MediatedTargetConfig& config) noexcept;

  // At rest in X_MT: when the robot begins to follow. Places known before mean others now.
  void start(const Pose& X_MT) noexcept;
  // The target after this tick, as a handle pose. The caller limits its speed.
  Pose step(const TargetInputs& in) noexcept;
  // What the master must know, into the next message.
  void tell(SlaveToMaster& out) const noexcept;

 private:
  WallFinder finder_;
  ConcealmentConfig concealment_;
  std::optional<DampedTurn> rotation_;
};

}  // namespace farhand
