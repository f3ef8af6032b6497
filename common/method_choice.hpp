// Which compensation suits a link and an environment, and why. Direct feedback while the device's
// damping can pay for the delay, kf ke RTT < B_h, with a factor of 2 in hand; above it the wall
// rendered at the master, once the slave is sure of it; else P+d, which needs to know nothing.
// Changes only where the hand feels little, but for direct feedback that rings or must soon: that
// is left at once. By a blend (MethodBlend), and not back and forth: a limit that was
// crossed must be undercut by a fifth.
#pragma once

#include <algorithm>

#include "common/geometry.hpp"
#include "common/method.hpp"

namespace farhand {

struct MethodChoiceConfig {
  double device_damping = 10;  // B_h [N s/m] of hand and device, dependable
  double stiffest = 1000;      // k [N/m] expected, as felt, while none is known; > 0
  double sure_for = 1;         // [s] that the model must have been sure and the wall still
  double quiet = 0.5;          // [N] felt, below which a change is not noticed
};

struct MethodChoice {
  Method method = Method::damped;
  const char* reason = "no answer yet";
};

// What is known in a tick.
struct MethodEvidence {
  double rtt = 0;        // round trip that hardly any message exceeds [s]; 0: not known
  bool sure = false;     // the slave's model of the wall is confident and the wall has not moved
  double stiffness = 0;  // of that wall as felt [N/m]; 0: none known
  double felt = 0;       // force now [N]
  bool ringing = false;  // direct feedback gave the hand more energy than it had from it
};

class MethodChooser {
 public:
  explicit MethodChooser(const MethodChoiceConfig& config) noexcept : config_(config) {}

  // RTT [s] below which direct feedback is chosen, where the wall has this stiffness.
  double direct_limit(double stiffness = 0) const noexcept {
    return config_.device_damping / (2 * std::max(stiffness, config_.stiffest));
  }

  // Once per tick.
  const MethodChoice& step(const MethodEvidence& e, double Ts) noexcept {
    sure_ = e.sure ? std::min(sure_ + Ts, config_.sure_for) : 0;
    rang_ = rang_ || e.ringing;
    if (!(e.rtt > 0)) return choice_;
    const bool was_direct = choice_.method == Method::direct;
    const double limit = direct_limit(e.stiffness);
    const MethodChoice wish = wished(e.rtt < limit * (was_direct ? 1 : 0.8));
    const bool urgent = was_direct && (rang_ || e.rtt > 2 * limit);  // the damping is used up
    if (wish.method == choice_.method || e.felt < config_.quiet || urgent) choice_ = wish;
    return choice_;
  }
  // The robot was uncoupled: what comes may be another place.
  void forget() noexcept {
    sure_ = 0;
    rang_ = false;
  }

 private:
  MethodChoice wished(bool quick) const noexcept {
    if (quick && !rang_) return {Method::direct, "the device's damping pays for this delay"};
    if (sure_ >= config_.sure_for)
      return {Method::mmt, "too slow for direct; the wall is known and still"};
    if (quick) return {Method::damped, "direct rang, so the wall is too stiff for it"};
    return {Method::damped, "too slow for direct; the wall is not known"};
  }

  MethodChoiceConfig config_;
  MethodChoice choice_;
  double sure_ = 0;
  bool rang_ = false;
};

// From one method's force to another's without a jump: the new one comes as the old one goes. What
// is left of the old one is under no guard any more, so it may only resist.
class MethodBlend {
 public:
  static constexpr double kTime = 0.3;  // [s]
  void start(const Vec3& F_before) noexcept { from_ = F_before, left_ = 1; }
  // Share of the new method's force.
  double step(double Ts) noexcept {
    left_ = std::max(left_ - Ts / kTime, 0.0);
    return 1 - left_;
  }
  // Of the old one, of the handle on what it is coupled to, while the handle moves with v.
  Vec3 rest(const Vec3& v) const noexcept {
    return from_.dot(v) >= 0 ? Vec3(left_ * from_) : Vec3::Zero();
  }

 private:
  Vec3 from_ = Vec3::Zero();
  double left_ = 0;
};

}  // namespace farhand
