#include "slave/compensation/chosen_target.hpp"

namespace farhand {

ChosenTarget::ChosenTarget(const ChosenTargetConfig& c) noexcept
    : damped_(c.damped), mediated_(c.mediated), concealment_(c.mediated.concealment) {
  if (c.rotation) rotation_.emplace(*c.rotation);
}

void ChosenTarget::start(const Pose& X_MT) noexcept {
  damped_.start(X_MT);
  mediated_.start(X_MT);
  if (rotation_) rotation_->start(X_MT.R);
}

Pose ChosenTarget::step(const TargetInputs& in) noexcept {
  const MasterToSlave& handle = in.handle;
  Pose next = mediated_.step(in);  // watches in any case
  if (method_ == Method::damped && handle.method != method_) damped_.change_over();
  method_ = handle.method;
  if (method_ == Method::damped)
    next.p = damped_.step(in).p;
  else
    damped_.start(in.X_MT);  // the mass goes with the target, at its speed
  if (method_ != Method::damped && method_ != Method::mmt)
    next.p = handle.p_MH + path(concealment_, in.age) * handle.V_MH.linear;
  if (rotation_) next.R = rotation_->step(in);
  return next;
}

void ChosenTarget::tell(SlaveToMaster& out) const noexcept {
  mediated_.tell(out);
  damped_.tell(out);
  if (rotation_) out.energies.rotation = rotation_->told();
}

}  // namespace farhand
