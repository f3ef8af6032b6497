#include "master/compensation/chosen_coupling.hpp"

#include "common/limits.hpp"

namespace farhand {

ChosenCoupling::ChosenCoupling(const ChosenCouplingConfig& c) noexcept
    : Ts_(c.damped.guard.Ts),
      delay_(c.delay),
      chooser_(c.choice),
      damped_(c.damped),
      mediated_(c.mediated),
      tank_(c.mediated.tank),
      max_force_(c.damped.max_force) {
  if (c.rotation) rotation_.emplace(*c.rotation);
}

Wrench ChosenCoupling::step(const CouplingInputs& in) noexcept {
  choose(in);
  const LocalWall& wall = in.robot.wall;
  const OperatorAllowance allowed = tank_.step(F_M_, in.handle.X_MH.p, wall.net, wall.contacts);
  const double share = fade_in_.step(in.share, Ts_);
  CouplingInputs blended = in;
  blended.share = share * blend_.step(Ts_);
  F_M_ = in.handle.R_MG * force(blended, allowed).force + blend_.rest(in.V_MH.linear);
  Wrench F_G{.force = in.handle.R_MG.transpose() * F_M_};
  if (rotation_) F_G.torque = rotation_->step(in, share);
  return F_G;
}

void ChosenCoupling::choose(const CouplingInputs& in) noexcept {
  const Method before = choice_.method;
  const LocalWall& wall = in.robot.wall;
  choice_ = chooser_.step({.rtt = delay_.step(in.echo_age),
                           .sure = wall.sure,
                           .stiffness = wall.sure ? wall.k : 0,
                           .felt = F_M_.norm(),
                           .ringing = ringing_},
                          Ts_);
  if (choice_.method == before) return;
  ringing_ = false;
  blend_.start(F_M_);
  damped_.change_over();
  mediated_.let_go();
}

Wrench ChosenCoupling::force(const CouplingInputs& in, const OperatorAllowance& allowed) noexcept {
  switch (choice_.method) {
    case Method::mmt:
      return mediated_.render(in, allowed);
    case Method::direct:
      return direct(in, allowed);
    default:
      return damped_.step(in);
  }
}

// The contact force as it comes; what drives the hand must have been put in.
Wrench ChosenCoupling::direct(const CouplingInputs& in, const OperatorAllowance& allowed) noexcept {
  ringing_ = allowed.share < 1;
  Vec3 F_M = in.share * clamp_norm(in.robot.F_E_M.force, max_force_);
  if (F_M.dot(in.V_MH.linear) < 0) F_M *= allowed.share;
  return {.force = in.handle.R_MG.transpose() * F_M};
}

void ChosenCoupling::let_go() noexcept {
  F_M_.setZero();
  ringing_ = false;
  chooser_.forget();
  blend_ = {};
  damped_.let_go();
  mediated_.let_go();
  if (rotation_) rotation_->let_go();
}

void ChosenCoupling::tell(MasterToSlave& out) const noexcept {
  damped_.tell(out);
  if (rotation_) out.energies.rotation = rotation_->told();
  out.method = choice_.method;
  out.has_felt = true;
  out.F_felt_M = F_M_;
}

}  // namespace farhand
