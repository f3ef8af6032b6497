// Finite, clamp, slew: the only code that may change a command for safety, always in this order,
// last before the write.
#pragma once

#include <algorithm>
#include <cmath>
#include <cstdint>

#include "common/geometry.hpp"

namespace farhand {

// What made a command differ from what was asked for; a set of bits, published every tick. None of
// these stops anything.
enum Limit : std::uint32_t {
  kLimitNone = 0,
  kLimitNotFinite = 1u << 0,  // a command was not finite and was replaced by the stated fallback
  kLimitForce = 1u << 1,      // clamped at the largest force or torque
  kLimitSlew = 1u << 2,       // its change was clamped
  kLimitWorkspace = 1u << 3,  // target unreachable or out of joint limits: last joint command held,
                              // or sliding along the boundary
  kLimitSpeed = 1u << 4,      // tool or joint speed clamped: the robot follows later
  kLimitStale = 1u << 5,      // input too old: held, then faded
  kLimitAcceptance = 1u << 6,  // handle outside its accepted workspace: no force
  kLimitSaturated = 1u << 7,   // a controller's integral was stopped by its output limit
};
using LimitSet = std::uint32_t;
constexpr int kLimitCount = 8;

constexpr const char* limit_name(int bit) noexcept {
  constexpr const char* kNames[kLimitCount] = {"not_finite", "force", "slew",       "workspace",
                                               "speed",      "stale", "acceptance", "saturated"};
  return kNames[bit];
}

template <typename Derived>
bool is_finite(const Eigen::MatrixBase<Derived>& v) noexcept {
  return v.allFinite();
}
inline bool is_finite(const Wrench& F) noexcept {
  return F.force.allFinite() && F.torque.allFinite();
}

// Beyond this [N], [N m], [rad], [rad/s] no sensor means what it says, and no square or product
// of what is below overflows.
inline constexpr double kAbsurd = 1e6;
// Finite, and sensible.
inline bool plausible(const Wrench& F) noexcept {
  return F.force.squaredNorm() + F.torque.squaredNorm() < kAbsurd * kAbsurd;
}

// v shortened to at most `max` in length; its direction stays. max >= 0.
template <typename Vector>
Vector clamp_norm(const Vector& v, double max) noexcept {
  const double n = v.norm();
  return n > max ? Vector(v * (max / n)) : v;
}

// v scaled as a whole so that no element exceeds its limit in size; keeps the direction.
template <typename Vector>
Vector clamp_scaled(const Vector& v, double max) noexcept {
  const double n = v.cwiseAbs().maxCoeff();
  return n > max ? Vector(v * (max / n)) : v;
}

// Limits of a wrench the hand feels, in handle axes: |force|, |torque|, |torque about the twist
// axis z|, and their rates of change per tick. The twist goes from nothing to its limit in the time
// the torque takes to its own: at the same rate the motors' own slew limit would hold all else
// back.
struct WrenchLimits {
  double force = 0;         // [N]
  double torque = 0;        // [N m]
  double twist_torque = 0;  // [N m]
  double force_step = 0;    // [N per tick]
  double torque_step = 0;   // [N m per tick]
};

// Limits `wanted` against the last command; a non-finite wish becomes zero (and fades to it by the
// slew limit). Twist first, then the whole vector, so that the direction is kept.
inline Wrench limit_wrench(const WrenchLimits& limits, Wrench wanted, const Wrench& last,
                           LimitSet& set) noexcept {
  if (!is_finite(wanted)) wanted = {}, set |= kLimitNotFinite;
  Wrench F = wanted;
  F.torque.z() = std::clamp(F.torque.z(), -limits.twist_torque, limits.twist_torque);
  F.force = clamp_norm(F.force, limits.force);
  F.torque = clamp_norm(F.torque, limits.torque);
  if (F.force != wanted.force || F.torque != wanted.torque) set |= kLimitForce;
  const Vec3 df = F.force - last.force, dm = F.torque - last.torque;
  const double twist_weight =
      limits.twist_torque > 0 ? std::max(1.0, limits.torque / limits.twist_torque) : 1;
  const double turn = Vec3(dm.x(), dm.y(), twist_weight * dm.z()).norm();
  if (df.squaredNorm() > limits.force_step * limits.force_step || turn > limits.torque_step) {
    set |= kLimitSlew;
    F.force = last.force + clamp_norm(df, limits.force_step);
    F.torque = last.torque + (turn > limits.torque_step ? limits.torque_step / turn : 1.0) * dm;
  }
  return F;
}

// Motor torques of the handle: scaled as a whole to `max` [N m], then the change scaled to
// `max_step` [N m per tick]. Not finite: zero at once, the one case in which the hand is let go
// without a ramp.
inline Vec6 limit_motor_torques(double max, double max_step, const Vec6& tau, const Vec6& last,
                                LimitSet& set) noexcept {
  if (!is_finite(tau)) {
    set |= kLimitNotFinite;
    return Vec6::Zero();
  }
  const Vec6 clamped = clamp_scaled(tau, max);
  if (clamped != tau) set |= kLimitForce;
  const Vec6 change = clamped - last;
  const Vec6 allowed = clamp_scaled(change, max_step);
  if (allowed == change) return clamped;
  set |= kLimitSlew;
  return last + allowed;
}

// Joint torques of the robot, each axis by itself. Not finite: the last command stays, since zero
// would drop the arm.
inline Vec6 limit_joint_torques(const Vec6& max, const Vec6& max_step, const Vec6& tau,
                                const Vec6& last, LimitSet& set) noexcept {
  if (!is_finite(tau)) {
    set |= kLimitNotFinite;
    return last;
  }
  const Vec6 clamped = tau.cwiseMax(-max).cwiseMin(max);
  if (clamped != tau) set |= kLimitForce;
  const Vec6 out = clamped.cwiseMax(last - max_step).cwiseMin(last + max_step);
  if (out != clamped) set |= kLimitSlew;
  return out;
}

}  // namespace farhand
