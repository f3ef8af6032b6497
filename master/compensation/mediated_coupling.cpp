#include "master/compensation/mediated_coupling.hpp"

#include "common/limits.hpp"

namespace farhand {

MediatedCoupling::MediatedCoupling(const MediatedCouplingConfig& c) noexcept
    : renderer_(c.renderer), tank_(c.tank), max_force_(c.max_force), Ts_(c.renderer.Ts) {
  if (c.rotation) rotation_.emplace(*c.rotation);
}

Wrench MediatedCoupling::step(const CouplingInputs& in) noexcept {
  const LocalWall& wall = in.robot.wall;
  return render(in, tank_.step(F_M_, in.handle.X_MH.p, wall.net, wall.contacts));
}

Wrench MediatedCoupling::render(const CouplingInputs& in,
                                const OperatorAllowance& allowed) noexcept {
  const double share = fade_in_.step(in.share, Ts_);
  const Vec3 F_M = renderer_.step(in.handle.X_MH.p, in.V_MH.linear, in.robot.wall, allowed);
  F_M_ = share * clamp_norm(F_M, max_force_);
  Wrench F_G{.force = in.handle.R_MG.transpose() * F_M_};
  if (rotation_) F_G.torque = rotation_->step(in, share);
  return F_G;
}

void MediatedCoupling::let_go() noexcept {
  F_M_.setZero();
  renderer_.forget();
  if (rotation_) rotation_->let_go();
}

void MediatedCoupling::tell(MasterToSlave& out) const noexcept {
  out.method = Method::mmt;
  out.has_felt = true;
  out.F_felt_M = F_M_;
  out.energies = {0, rotation_ ? rotation_->told() : 0};
}

}  // namespace farhand
