#include "master/compensation/direct_coupling.hpp"

#include "common/limits.hpp"

namespace farhand {

DirectCoupling::DirectCoupling(const DirectCouplingConfig& c) noexcept
    : max_force_(c.max_force),
      max_torque_(c.max_torque),
      Ts_(c.translation.Ts),
      translation_(c.translation) {
  if (c.rotation) rotation_.emplace(*c.rotation);
}

Wrench DirectCoupling::step(const CouplingInputs& in) noexcept {
  const double share = fade_in_.step(in.share, Ts_);
  const Wrench& F_M = in.robot.F_E_M;
  const Pose& X_MH = in.handle.X_MH;
  const Mat3 R_GM = in.handle.R_MG.transpose();
  translation_.hear(in.robot.energies.translation);
  Wrench F_G{.force = R_GM * translation_.step(share * clamp_norm(F_M.force, max_force_), X_MH.p)};
  if (!rotation_) return F_G;
  rotation_->hear(in.robot.energies.rotation);
  if (R_) turned_ += rotation_vector(X_MH.R * R_->transpose());
  R_ = X_MH.R;
  F_G.torque = R_GM * rotation_->step(share * clamp_norm(F_M.torque, max_torque_), turned_);
  return F_G;
}

void DirectCoupling::let_go() noexcept {
  translation_.let_go();
  if (rotation_) rotation_->let_go();
  R_.reset();
}

void DirectCoupling::tell(MasterToSlave& out) const noexcept {
  out.method = Method::direct;
  out.energies = {translation_.told(), rotation_ ? rotation_->told() : 0};
}

}  // namespace farhand
