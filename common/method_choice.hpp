// Which compensation suits a link and an environment, and why. Direct feedback while the device's
// damping can pay for the delay, kf ke RTT < B_h, with a factor of 2 in hand; above it the wall
// rendered at the master, once the slave is sure of it; else P+d, which needs to know nothing.
// Changes only where the hand feels little, but for direct feedback beyond twice its limit, which
// rings: that is left at once. By a blend (MethodBlend), and not back and forth: a limit that was
// crossed must be undercut by a fifth.
#pragma once

#include <algorithm>

#include "common/geometry.hpp"
#include "common/method.hpp"

namespace farhand {

struct MethodChoiceConfig {
  double device_damping = 10;  // B_h [N s/m] of hand and device, dependable
  double force_share = 1;      // kf
  double stiffest = 1000;      // ke [N/m] expected
  double sure_for = 1;         // [s] that the model must have been sure and the wall still
  double quiet = 0.5;          // [N] felt, below which a change is not noticed
};

struct MethodChoice {
  Method method = Method::damped;
  const char* reason = "no answer yet";
};

class MethodChooser {
 public:
  explicit MethodChooser(const MethodChoiceConfig& config) noexcept : config_(config) {}

  // RTT [s] below which direct feedback is chosen.
  double direct_limit() const noexcept {
    return config_.device_damping / (2 * config_.force_share * config_.stiffest);
  }

  // Once per tick. rtt: round trip that 99 % stay below [s], 0 if not known; sure: the slave's
  // model of the wall is confident and the wall has not moved; felt: force now.
  const MethodChoice& step(double rtt, bool sure, double felt, double Ts) noexcept {
    sure_ = sure ? std::min(sure_ + Ts, config_.sure_for) : 0;
    if (!(rtt > 0)) return choice_;
    const bool was_direct = choice_.method == Method::direct;
    const bool direct = rtt < direct_limit() * (was_direct ? 1 : 0.8);
    const bool modelled = sure_ >= config_.sure_for;
    const MethodChoice wish =
        direct     ? MethodChoice{Method::direct, "the device's damping pays for this delay"}
        : modelled ? MethodChoice{Method::mmt, "too long for direct; the wall is known and still"}
                   : MethodChoice{Method::damped, "too long for direct; the wall is not known"};
    const bool urgent = was_direct && rtt > 2 * direct_limit();  // the damping is used up
    if (wish.method == choice_.method || felt < config_.quiet || urgent) choice_ = wish;
    return choice_;
  }

 private:
  MethodChoiceConfig config_;
  MethodChoice choice_;
  double sure_ = 0;
};

// From one method's force to another's without a jump.
class MethodBlend {
 public:
  static constexpr double kTime = 0.3;  // [s]
  void start(const Vec3& F_before) noexcept { from_ = F_before, left_ = 1; }
  Vec3 step(const Vec3& F, double Ts) noexcept {
    left_ = std::max(left_ - Ts / kTime, 0.0);
    return F + left_ * (from_ - F);
  }

 private:
  Vec3 from_ = Vec3::Zero();
  double left_ = 0;
};

}  // namespace farhand
