#include "master/compensation/damped_coupling.hpp"

#include "common/limits.hpp"

namespace farhand {

DampedCoupling::DampedCoupling(const DampedCouplingConfig& c) noexcept
    : spring_(c.translation), max_force_(c.max_force), Ts_(c.guard.Ts), translation_(c.guard) {
  if (c.rotation) rotation_.emplace(*c.rotation);
}

Wrench DampedCoupling::step(const CouplingInputs& in) noexcept {
  const double share = fade_in_.step(in.share, Ts_);
  translation_.hear(in.robot.energies.translation);
  const Vec3& p_MH = in.handle.X_MH.p;
  const Vec3 stretch = in.robot.has_robot ? Vec3(p_MH - in.robot.p_MR) : Vec3::Zero();
  const Vec3 F_M = share * spring_.step(stretch, in.V_MH.linear, in.robot.F_E_M.force, in.echo_age);
  Wrench F_G{.force =
                 in.handle.R_MG.transpose() * translation_.step(clamp_norm(F_M, max_force_), p_MH)};
  if (rotation_) F_G.torque = rotation_->step(in, share);
  return F_G;
}

void DampedCoupling::let_go() noexcept {
  translation_.let_go();
  if (rotation_) rotation_->let_go();
}

void DampedCoupling::change_over() noexcept {
  let_go();
  translation_.cap();
}

void DampedCoupling::tell(MasterToSlave& out) const noexcept {
  out.method = Method::damped;
  out.energies = {translation_.told(), rotation_ ? rotation_->told() : 0};
}

}  // namespace farhand
