#include "master/compensation/smith_coupling.hpp"

#include "common/limits.hpp"
#include "master/compensation/operator_tank.hpp"

namespace farhand {

SmithCoupling::SmithCoupling(const SmithCouplingConfig& c) noexcept
    : predictor_(c.model), max_force_(c.max_force), Ts_(c.model.Ts), guard_(c.guard) {
  if (c.rotation) rotation_.emplace(*c.rotation);
}

Wrench SmithCoupling::step(const CouplingInputs& in) noexcept {
  const double share = fade_in_.step(in.share, Ts_);
  const Vec3& p_MH = in.handle.X_MH.p;
  const TimePoint acted =
      in.robot.has_acted ? TimePoint{Duration(static_cast<Duration::rep>(in.robot.acted))} : in.now;
  predictor_.place(in.robot.wall);
  const Vec3 F_M = predictor_.step(p_MH, in.V_MH.linear, in.robot.F_E_M.force, acted, in.now);
  guard_.budget().receive(guard_.budget().in());
  guard_.budget().cap(kOperatorCap);
  Wrench F_G{.force = in.handle.R_MG.transpose() *
                      guard_.step(share * clamp_norm(F_M, max_force_), p_MH)};
  if (rotation_) F_G.torque = rotation_->step(in, share);
  return F_G;
}

void SmithCoupling::let_go() noexcept {
  predictor_.restart();
  guard_.let_go();
  if (rotation_) rotation_->let_go();
}

void SmithCoupling::tell(MasterToSlave& out) const noexcept {
  out.method = Method::smith;
  out.energies = {0, rotation_ ? rotation_->told() : 0};
}

}  // namespace farhand
