// The master's half of P+d (common/damped.hpp): a spring to where the robot is known to be, and a
// damper. In a gap the spring pulls to the last known place, the damper grows with the gap's age,
// and the caller fades the whole by kSpringFade and back in by FadeIn.
#pragma once

#include "common/damped.hpp"
#include "common/geometry.hpp"
#include "master/compensation.hpp"

namespace farhand {

// A spring to a known place is no force to be held back at once: whole for 100 ms of silence, in
// which the damper grows with it, then gone in as long.
inline constexpr CompensationConfig kSpringFade{.hold = std::chrono::milliseconds(100),
                                                .fade = std::chrono::milliseconds(100)};

class DampedMaster {
 public:
  explicit DampedMaster(const DampedConfig& config) noexcept
      : config_(config), delay_(config.delay) {}

  // Force of the handle on the coupling (the hand feels its opposite). stretch: handle less robot,
  // as a difference of positions or a rotation vector, from the newest message; v_m the handle's
  // velocity, undelayed; F_e of the same message, robot on environment, of use with `touch` alone.
  // A pure damper while the robot's place is not known: stretch = 0.
  Vec3 step(const Vec3& stretch, const Vec3& v_m, const Vec3& F_e, Duration echo_age) noexcept {
    const SpringDamper s = spring_damper(config_, delay_.step(echo_age));
    const double on = touch_.step(config_.touch, F_e.norm(), config_.delay.Ts);
    const double drag = config_.touch ? (1 - on) * config_.touch->drag : 0;
    const double share = coupling_share(config_.delay, echo_age);
    return share * (on * s.K * stretch + (on * s.B + drag) * v_m);
  }
  double delay() const noexcept { return delay_.delay(); }

 private:
  DampedConfig config_;
  EchoDelay delay_;
  TouchCoupling touch_;
};

}  // namespace farhand
