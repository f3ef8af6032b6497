// The master's half of the wave method (common/wave.hpp).
#pragma once

#include <limits>

#include "common/limits.hpp"
#include "common/wave.hpp"

namespace farhand {

class WaveMaster {
 public:
  explicit WaveMaster(const WaveConfig& config) noexcept : config_(config), in_(config) {}

  // Of every message, in any order.
  void push(Duration sent, const WaveSum& sum, Duration now) noexcept { in_.push(sent, sum, now); }

  // See WaveReceiver.
  void start() noexcept { in_.start(); }
  void clear() noexcept { in_.clear(); }

  // Force of the handle on the coupling; v_m the handle's velocity. The hand is given `share` of
  // it, `most` [N] at most; a wave that it does not pay for then is not sent.
  Vec3 step(const Vec3& v_m, Duration now, double share = 1,
            double most = std::numeric_limits<double>::infinity()) noexcept {
    const double root = std::sqrt(2 * config_.b);
    const Vec3 w = in_.step(now), F = config_.b * v_m - root * w;
    const Vec3 given = share * clamp_norm(F, most);
    Vec3 u = root * v_m - w;
    const double allowed = std::max(w.squaredNorm() + 2 * given.dot(v_m), 0.0);
    const double u2 = u.squaredNorm();
    if (given != F && u2 > allowed) u *= std::sqrt(allowed / u2);
    sent_ = after(sent_, u, config_.Ts);
    return given;
  }
  const WaveSum& sum() const noexcept { return sent_; }  // to be sent
  double playout() const noexcept { return in_.delay(); }

 private:
  WaveConfig config_;
  WaveReceiver in_;
  WaveSum sent_;
};

}  // namespace farhand
