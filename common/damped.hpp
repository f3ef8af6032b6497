// P+d: handle and robot coupled by a spring through the network, each with a damper of its own
// (Nuno, Basanez and Ortega 2011, Automatica 47, 485), what both sides must agree on. With the
// delays' bound T* of both ways together,
//
//   master  F_fb = K (x_m - x_s(t - T2)) + B v_m       slave  F_s = K (x_m(t - T1) - x_s) - B v_s
//   4 B_m B_s > T*^2 K_m K_s
//
// so that B = K T* / 2 on either side is the bound. Guaranteed then, for delays that vary and for
// losses (a loss is a longer delay, and in T*): bounded velocities, and no lasting position error
// in free motion. Costs: the hand feels the wall and the spring in series, ke K / (ke + K), and
// drag of some 2 K T* v.
//
// With `touch`, for a slave that measures its contact force, the hand is coupled only while the
// robot touches something; free, it feels a small drag, and the slave follows with a small damping.
// K may then be several times larger for less drag. In contact the bound holds as before; the
// energy that the spring is switched on with is for the guards to bound.
#pragma once

#include <algorithm>
#include <optional>

#include "common/echo_delay.hpp"

namespace farhand {

struct TouchConfig {
  double force = 0.3;              // [N] of contact, above which it is one
  double rise = 0.02, fall = 0.3;  // [s] from free to coupled, and back
  double drag = 12, damping = 30;  // [N s/m] free, at the master and at the slave
};

// Share of the coupling, 0 free to 1 in contact.
class TouchCoupling {
 public:
  double step(const std::optional<TouchConfig>& c, double F_e, double Ts) noexcept {
    if (!c) return 1;
    share_ = std::clamp(share_ + (F_e > c->force ? Ts / c->rise : -Ts / c->fall), 0.0, 1.0);
    return share_;
  }

 private:
  double share_ = 0;
};

// For translation [N/m], [N s/m]; for rotation [N m/rad], [N m s].
struct DampedConfig {
  double stiffness = 400;
  double margin = 1.05;      // of the damping over the bound
  double max_damping = 100;  // what the device can render; the spring yields where it would take
                             // more
  EchoDelayConfig delay;
  std::optional<TouchConfig> touch{};
};

struct SpringDamper {
  double K = 0, B = 0;
};

// For T* [s]. Each side uses the T* it sees; the bound holds with either.
inline SpringDamper spring_damper(const DampedConfig& c, double T) noexcept {
  const double per_stiffness = c.margin * T / 2;
  const double K = std::min(c.stiffness, c.max_damping / std::max(per_stiffness, 1e-9));
  return {.K = K, .B = K * per_stiffness};
}

}  // namespace farhand
