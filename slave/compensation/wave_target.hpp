// The wave method at the robot (slave/compensation/wave.hpp): the waves push a virtual mass, and
// where that stands is where the robot is told to go. The orientation follows by P+d.
#pragma once

#include <optional>

#include "common/peer.hpp"
#include "slave/compensation/damped.hpp"
#include "slave/compensation/damped_turn.hpp"
#include "slave/compensation/inputs.hpp"
#include "slave/compensation/wave.hpp"

namespace farhand {

struct WaveTargetConfig {
  WaveConfig translation;
  double servo_stiffness = 20000;  // Kp [N/m] of the robot at the tool, in the handle's terms
  VirtualMassConfig mass;
  std::optional<DampedTurnConfig> rotation;  // nothing: the orientation stays
};

class WaveTarget {
 public:
  explicit WaveTarget(const WaveTargetConfig& config) noexcept;

  // In every tick with a message, before the step if there is one.
  void hear(const Peer<MasterToSlave>& master, TimePoint now) noexcept;
  // At rest in X_MT: when the robot begins to follow.
  void start(const Pose& X_MT) noexcept;
  // The target after this tick, as a handle pose. The caller limits its speed.
  Pose step(const TargetInputs& in) noexcept;
  // What the master must know, into the next message.
  void tell(SlaveToMaster& out) const noexcept;

 private:
  WaveSlave wave_;
  VirtualMassConfig mass_;
  std::uint64_t heard_ = 0;  // the master's session
  std::optional<DampedTurn> rotation_;
  Vec3 p_MT_ = Vec3::Zero();  // of the last tick
};

}  // namespace farhand
