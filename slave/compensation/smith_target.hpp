// The Smith predictor's half at the robot (master/compensation/smith.hpp): the handle's poses are
// played evenly, and the master is told which one the force answers and where the registered wall
// is in the handle's terms. The orientation follows by P+d.
#pragma once

#include <optional>

#include "common/local_wall.hpp"
#include "common/peer.hpp"
#include "common/playout.hpp"
#include "slave/compensation/damped_turn.hpp"
#include "slave/compensation/inputs.hpp"
#include "slave/workspace.hpp"

namespace farhand {

struct SmithTargetConfig {
  PlayoutConfig playout;
  LocalWall wall;  // registered: x_w and n in S; k and b of the wall alone, in the handle's terms
  std::optional<DampedTurnConfig> rotation;  // nothing: the orientation stays
};

class SmithTarget {
 public:
  explicit SmithTarget(const SmithTargetConfig& config) noexcept;

  // In every tick with a message, before the step if there is one.
  void hear(const Peer<MasterToSlave>& master, TimePoint now) noexcept;
  // At rest in X_MT: when the robot begins to follow.
  void start(const Pose& X_MT) noexcept;
  // With start: what the handle's pose means from now on.
  void place(const WorkspaceConfig& config, const WorkspaceState& workspace) noexcept;
  // The target after this tick, as a handle pose. The caller limits its speed.
  Pose step(const TargetInputs& in) noexcept;
  // What the master must know, into the next message.
  void tell(SlaveToMaster& out) const noexcept;

 private:
  SmithTargetConfig config_;
  Playout<Vec3> poses_;
  LocalWall wall_;           // in the handle's terms
  std::uint64_t heard_ = 0;  // the master's session
  std::optional<DampedTurn> rotation_;
};

}  // namespace farhand
