// The slave's half of P+d (common/damped.hpp). The robot is a stiff position servo, so the force
// law is turned into motion: a virtual mass in the robot's place,
//
//   M dv/dt = K (x_m - x_sd) - (B + B_c) v - F_e
//
// whose position x_sd the robot is told. B_c is there in contact only, where the servo's lag turns
// part of a stiff wall into negative damping; in free motion it would be drag. In a gap the mass is
// pulled to where the handle is thought to be (common/concealment.hpp) and comes to rest there.
//
// The guard (common/force_guard.hpp) belongs between the spring and the mass, at the port (v, F_s):
// what it takes to move the mass then comes back when the mass is stopped, and is seen to. At the
// contact the master's guard would run dry in free motion, by the mass's energy at every turn.
#pragma once

#include "common/damped.hpp"
#include "common/geometry.hpp"
#include "common/limits.hpp"

namespace farhand {

// For rotation [kg m^2], [N m s], [N m], [rad/s].
struct VirtualMassConfig {
  double Ts = 0.001;
  double mass = 1;              // [kg] > 0
  double contact_damping = 40;  // [N s/m]
  double contact_force = 1;     // [N] at which half of it acts
  double max_speed = 1;         // [m/s]
};

class DampedSlave {
 public:
  explicit DampedSlave(const DampedConfig& config) noexcept
      : config_(config), delay_(config.delay) {}

  // F_s, of the network on the mass. stretch: handle, as received, less the target; v the velocity
  // the target had in the last tick, whoever limited it; F_e robot on environment, of use with
  // `touch` alone. All in the handle's terms.
  Vec3 step(const Vec3& stretch, const Vec3& v, const Vec3& F_e, Duration echo_age) noexcept {
    const SpringDamper s = spring_damper(config_, delay_.step(echo_age));
    const double on = touch_.step(config_.touch, F_e.norm(), config_.delay.Ts);
    const double free = config_.touch ? (1 - on) * config_.touch->damping : 0;
    return coupling_share(config_.delay, echo_age) * s.K * stretch - (on * s.B + free) * v;
  }
  double delay() const noexcept { return delay_.delay(); }

 private:
  DampedConfig config_;
  EchoDelay delay_;
  TouchCoupling touch_;
};

// Velocity of the target in this tick, under F_s of the network and F_e, robot on environment.
// Semi-implicit in B_c: stable at any.
inline Vec3 step(const VirtualMassConfig& c, const Vec3& v, const Vec3& F_s,
                 const Vec3& F_e) noexcept {
  const double h = c.Ts / c.mass, f = F_e.norm();
  const double B = c.contact_damping * f / (f + c.contact_force);
  return clamp_norm(Vec3((v + h * (F_s - F_e)) / (1 + h * B)), c.max_speed);
}

}  // namespace farhand
