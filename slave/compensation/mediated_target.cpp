#include "slave/compensation/mediated_target.hpp"

namespace farhand {

MediatedTarget::MediatedTarget(const MediatedTargetConfig& c) noexcept
    : finder_(c.finder), concealment_(c.concealment) {
  if (c.rotation) rotation_.emplace(*c.rotation);
}

void MediatedTarget::start(const Pose& X_MT) noexcept {
  finder_.forget();
  if (rotation_) rotation_->start(X_MT.R);
}

Pose MediatedTarget::step(const TargetInputs& in) noexcept {
  const Vec3 wish = in.handle.p_MH + path(concealment_, in.age) * in.handle.V_MH.linear;
  return {
      rotation_ ? rotation_->step(in) : in.X_MT.R,
      finder_.step(wish, in.handle.F_felt_M, in.X_MT.p, in.X_MR.p, in.V_MR.linear, in.F_E_M.force)};
}

void MediatedTarget::tell(SlaveToMaster& out) const noexcept {
  out.energies = {0, rotation_ ? rotation_->told() : 0};
  out.has_wall = true;
  out.wall = finder_.wall();
}

}  // namespace farhand
