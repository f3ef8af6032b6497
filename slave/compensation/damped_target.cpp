#include "slave/compensation/damped_target.hpp"

namespace farhand {

DampedTarget::DampedTarget(const DampedTargetConfig& c) noexcept
    : config_(c), spring_(c.translation), translation_(c.guard) {
  if (c.rotation) rotation_.emplace(*c.rotation);
}

void DampedTarget::start(const Pose& X_MT) noexcept {
  p_MT_ = X_MT.p;
  translation_.let_go();
  if (rotation_) rotation_->start(X_MT.R);
}

Pose DampedTarget::step(const TargetInputs& in) noexcept {
  translation_.hear(in.handle.energies.translation);
  const double Ts = config_.mass.Ts, reckoned = path(config_.concealment, in.age);
  const Vec3 &p = in.X_MT.p, &F_E = in.F_E_M.force;
  const Vec3 v = (p - p_MT_) / Ts;
  const Vec3 stretch = in.handle.p_MH + reckoned * in.handle.V_MH.linear - p;
  const Vec3 F_s = -translation_.step(-spring_.step(stretch, v, F_E, in.echo_age), p);
  p_MT_ = p;
  return {rotation_ ? rotation_->step(in) : in.X_MT.R,
          p + Ts * farhand::step(config_.mass, v, F_s, F_E)};
}

void DampedTarget::tell(SlaveToMaster& out) const noexcept {
  out.energies = {translation_.told(), rotation_ ? rotation_->told() : 0};
}

}  // namespace farhand
