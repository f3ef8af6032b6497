#include "slave/user_force.hpp"

#include "common/limits.hpp"

namespace farhand {

Wrench pushed(const UserForceConfig& c, const Wrench& F_user_S) noexcept {
  if (!is_finite(F_user_S)) return {};
  return {.force = clamp_norm(Vec3(c.share * F_user_S.force), c.max_force),
          .torque = clamp_norm(Vec3(c.share * F_user_S.torque), c.max_torque)};
}

Pose Admittance::step(const Pose& X_SE_target, const Wrench& F_user_S, const Wrench& F_env_S,
                      bool lock_rotation) noexcept {
  const AdmittanceConfig& c = config_;
  const Wrench F = F_user_S - F_env_S;
  const bool good = is_finite(F);
  const auto moved = [&](const Vec3& v, const Vec3& push, double inertia, double damping) -> Vec3 {
    return (v + (good ? Vec3(c.Ts / inertia * push) : Vec3::Zero())) /
           (1 + damping * c.Ts / inertia);
  };
  V_SE_.linear = clamp_norm(moved(V_SE_.linear, F.force, c.mass, c.damping), c.max_speed);
  Pose out{X_SE_target.R, X_SE_target.p + c.Ts * V_SE_.linear};
  if (lock_rotation) return out;
  V_SE_.angular =
      clamp_norm(moved(V_SE_.angular, F.torque, c.inertia, c.rotation_damping), c.max_turn_rate);
  // Made a rotation again each time: hours of ticks would round it away from one.
  out.R = Quat(rotation(c.Ts * V_SE_.angular) * X_SE_target.R).normalized().toRotationMatrix();
  return out;
}

}  // namespace farhand
