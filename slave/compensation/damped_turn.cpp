#include "slave/compensation/damped_turn.hpp"

namespace farhand {

void DampedTurn::start(const Mat3& R_MT) noexcept {
  R_MT_ = R_MT;
  port_.let_go();
}

Mat3 DampedTurn::step(const TargetInputs& in) noexcept {
  port_.hear(in.handle.energies.rotation);
  const double Ts = config_.inertia.Ts;
  const Mat3& R_MT = in.X_MT.R;
  const Vec3 moved = rotation_vector(R_MT * R_MT_.transpose());
  turned_ += moved;
  R_MT_ = R_MT;
  const double reckoned = path(config_.concealment, in.age);
  const Mat3 R_MH = rotation(reckoned * in.handle.V_MH.angular) * in.handle.q_MH.toRotationMatrix();
  const Vec3 turn = rotation_vector(R_MH * R_MT.transpose());
  const Vec3& tau_E = in.F_E_M.torque;
  const Vec3 tau_s = -port_.step(-spring_.step(turn, moved / Ts, tau_E, in.echo_age), turned_);
  const Vec3 rate = farhand::step(config_.inertia, moved / Ts, tau_s, tau_E);
  // Made a rotation again each time: hours of ticks would round it away from one.
  return Quat(rotation(Ts * rate) * R_MT).normalized().toRotationMatrix();
}

}  // namespace farhand
