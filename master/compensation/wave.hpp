// The master's half of the wave method (common/wave.hpp).
#pragma once

#include "common/wave.hpp"

namespace farhand {

class WaveMaster {
 public:
  explicit WaveMaster(const WaveConfig& config) noexcept : config_(config), in_(config) {}

  // Of every message, in any order.
  void push(Duration sent, const WaveSum& sum, Duration now) noexcept { in_.push(sent, sum, now); }

  // Force of the handle on the coupling; v_m the handle's velocity.
  Vec3 step(const Vec3& v_m, Duration now) noexcept {
    const double root = std::sqrt(2 * config_.b);
    const Vec3 w = in_.step(now);
    sent_ = after(sent_, root * v_m - w, config_.Ts);
    return config_.b * v_m - root * w;
  }
  const WaveSum& sum() const noexcept { return sent_; }  // to be sent
  double playout() const noexcept { return in_.delay(); }

 private:
  WaveConfig config_;
  WaveReceiver in_;
  WaveSum sent_;
};

}  // namespace farhand
