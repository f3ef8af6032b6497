#include "master/compensation/chosen_coupling.hpp"

namespace farhand {

ChosenCoupling::ChosenCoupling(const ChosenCouplingConfig& c) noexcept
    : Ts_(c.damped.guard.Ts),
      delay_(c.delay),
      chooser_(c.choice),
      damped_(c.damped),
      mediated_(c.mediated) {
  if (c.rotation) rotation_.emplace(*c.rotation);
}

Wrench ChosenCoupling::step(const CouplingInputs& in) noexcept {
  choose(in);
  Wrench F_G = force(in);
  F_M_ = blend_.step(in.handle.R_MG * F_G.force, Ts_);
  F_G.force = in.handle.R_MG.transpose() * F_M_;
  const double share = fade_in_.step(in.share, Ts_);
  if (rotation_) F_G.torque = rotation_->step(in, share);
  return F_G;
}

void ChosenCoupling::choose(const CouplingInputs& in) noexcept {
  const Method before = choice_.method;
  choice_ = chooser_.step(delay_.step(in.echo_age), in.robot.wall.sure, F_M_.norm(), Ts_);
  if (choice_.method == before) return;
  blend_.start(F_M_);
  damped_.change_over();
  mediated_.let_go();
}

Wrench ChosenCoupling::force(const CouplingInputs& in) noexcept {
  switch (choice_.method) {
    case Method::mmt:
      return mediated_.step(in);
    case Method::direct:
      return {.force = in.share * (in.handle.R_MG.transpose() * in.robot.F_E_M.force)};
    default:
      return damped_.step(in);
  }
}

void ChosenCoupling::let_go() noexcept {
  F_M_.setZero();
  blend_ = {};
  damped_.let_go();
  mediated_.let_go();
  if (rotation_) rotation_->let_go();
}

void ChosenCoupling::tell(MasterToSlave& out) const noexcept {
  damped_.tell(out);
  if (rotation_) out.energies.rotation = rotation_->told();
  out.method = choice_.method;
}

}  // namespace farhand
