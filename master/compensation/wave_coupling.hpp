// The wave method at the handle (common/wave.hpp): translation by waves, whose energy limit is its
// guard; rotation by P+d. No wave is sent while nothing of it is felt, so what the hand moves
// between its press and the word that the robot follows stays as an offset.
#pragma once

#include <optional>

#include "common/peer.hpp"
#include "master/compensation/damped_rotation.hpp"
#include "master/compensation/inputs.hpp"
#include "master/compensation/wave.hpp"

namespace farhand {

struct WaveCouplingConfig {
  WaveConfig translation;
  double max_force = 20;                         // [N] that the hand may feel
  std::optional<DampedRotationConfig> rotation;  // nothing: no torque
};

class WaveCoupling {
 public:
  explicit WaveCoupling(const WaveCouplingConfig& config) noexcept;

  // In every tick with a message, before the step if there is one.
  void hear(const Peer<SlaveToMaster>& slave, TimePoint now) noexcept;
  // Handle on coupling, G axes.
  Wrench step(const CouplingInputs& in) noexcept;
  // In a tick in which nothing of it is felt.
  void let_go() noexcept;
  // What the slave must know, into the next message.
  void tell(MasterToSlave& out) const noexcept;

 private:
  WaveMaster wave_;
  double max_force_, Ts_;
  FadeIn fade_in_;
  bool coupled_ = false;
  std::uint64_t heard_ = 0;  // the slave's session
  std::optional<DampedRotation> rotation_;
};

}  // namespace farhand
