// The slave's half of the wave method (common/wave.hpp). The wave drives a point x_p, and a spring
// and a damper between it and the virtual mass (slave/compensation/damped.hpp) exert F_s; the
// damper is b, so that a free robot reflects nothing. Both at once:
//
//   v_p = (sqrt(2 b) u - Kp (x_p - x_sd) + b v_sd) / 2 b,   F_s = sqrt(2 b) u - b v_p
//   w = u - sqrt(2 / b) F_s
#pragma once

#include "common/wave.hpp"

namespace farhand {

class WaveSlave {
 public:
  // stiffness: Kp [N/m], in series with the wall.
  explicit WaveSlave(const WaveConfig& config, double stiffness = 20000) noexcept
      : config_(config), stiffness_(stiffness), in_(config) {}

  void push(Duration sent, const WaveSum& sum, Duration now) noexcept { in_.push(sent, sum, now); }

  // A coupling begins; see WaveReceiver.
  void start() noexcept {
    in_.start();
    lead_.setZero();
  }
  void clear() noexcept { in_.clear(); }

  // F_s, of the network on the mass. v_sd: velocity of the target in the last tick.
  Vec3 step(const Vec3& v_sd, Duration now) noexcept {
    const double b = config_.b, root = std::sqrt(2 * b);
    lead_ -= config_.Ts * v_sd;  // the target moved
    const Vec3 u = in_.step(now);
    const Vec3 v_p = (root * u - stiffness_ * lead_ + b * v_sd) / (2 * b + config_.Ts * stiffness_);
    lead_ += config_.Ts * v_p;
    const Vec3 F_s = root * u - b * v_p;
    sent_ = after(sent_, u - std::sqrt(2 / b) * F_s, config_.Ts);
    return F_s;
  }
  const WaveSum& sum() const noexcept { return sent_; }
  double playout() const noexcept { return in_.delay(); }

 private:
  WaveConfig config_;
  double stiffness_;
  WaveReceiver in_;
  Vec3 lead_ = Vec3::Zero();  // x_p - x_sd
  WaveSum sent_;
};

}  // namespace farhand
