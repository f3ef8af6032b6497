#include "slave/compensation/damped_target.hpp"

namespace farhand {

DampedTarget::DampedTarget(const DampedTargetConfig& c) noexcept
    : config_(c),
      spring_(c.translation),
      turn_(c.turn),
      translation_(c.guard),
      rotation_(c.rotation_guard) {}

void DampedTarget::start(const Pose& X_MT) noexcept {
  X_MT_ = X_MT;
  translation_.let_go();
  rotation_.let_go();
}

Pose DampedTarget::step(const Pose& X_MT, const MasterToSlave& handle, Duration age,
                        Duration echo_age, const Wrench& F_E_M) noexcept {
  translation_.hear(handle.energies.translation);
  rotation_.hear(handle.energies.rotation);
  const double Ts = config_.mass.Ts, reckoned = path(config_.concealment, age);
  const Vec3 v = (X_MT.p - X_MT_.p) / Ts;
  const Vec3 stretch = handle.p_MH + reckoned * handle.V_MH.linear - X_MT.p;
  const Vec3 F_s = -translation_.step(-spring_.step(stretch, v, F_E_M.force, echo_age), X_MT.p);
  Pose next{X_MT.R, X_MT.p + Ts * farhand::step(config_.mass, v, F_s, F_E_M.force)};
  if (config_.rotation) {
    const Vec3 moved = rotation_vector(X_MT.R * X_MT_.R.transpose());
    turned_ += moved;
    const Mat3 R_MH = rotation(reckoned * handle.V_MH.angular) * handle.q_MH.toRotationMatrix();
    const Vec3 turn = rotation_vector(R_MH * X_MT.R.transpose());
    const Vec3 M_s =
        -rotation_.step(-turn_.step(turn, moved / Ts, F_E_M.torque, echo_age), turned_);
    const Vec3 rate = farhand::step(config_.inertia, moved / Ts, M_s, F_E_M.torque);
    // Made a rotation again each time: hours of ticks would round it away from one.
    next.R = Quat(rotation(Ts * rate) * X_MT.R).normalized().toRotationMatrix();
  }
  X_MT_ = X_MT;
  return next;
}

}  // namespace farhand
