#include "slave/compensation/direct_target.hpp"

#include "common/limits.hpp"

namespace farhand {

DirectTarget::DirectTarget(const DirectTargetConfig& c) noexcept
    : config_(c), translation_(c.translation) {
  if (c.rotation) rotation_.emplace(*c.rotation);
}

Vec3 DirectTarget::Port::step(const Moves& moves, const Vec3& F_E, double peer_in) noexcept {
  peer.hear(peer_in, guard.budget());
  const double Ts = guard.config().Ts;
  return Ts * guard.step(moves.handle / Ts, moves.stretch, F_E, moves.robot);
}

Pose DirectTarget::reckon(const TargetInputs& in) const noexcept {
  const MasterToSlave& handle = in.handle;
  const double reckoned = path(config_.concealment, in.age);
  return {rotation(reckoned * handle.V_MH.angular) * handle.q_MH.toRotationMatrix(),
          handle.p_MH + reckoned * handle.V_MH.linear};
}

Pose DirectTarget::step(const TargetInputs& in) noexcept {
  const Pose X_MH = reckon(in);
  if (!X_MR_) X_MR_ = in.X_MR;
  Moves moves{
      .handle = clamp_norm(Vec3(X_MH.p - X_MH_.p), config_.max_speed * config_.translation.Ts),
      .robot = in.X_MR.p - X_MR_->p};
  moves.stretch = X_MH.p - in.X_MT.p - moves.handle;
  const Vec3 move = translation_.step(moves, in.F_E_M.force, in.handle.energies.translation);
  const Pose next{rotation_ ? turn(in, X_MH.R) : in.X_MT.R, in.X_MT.p + move};
  X_MH_ = X_MH;
  X_MR_ = in.X_MR;
  return next;
}

Mat3 DirectTarget::turn(const TargetInputs& in, const Mat3& R_MH) noexcept {
  Moves moves{.handle = clamp_norm(rotation_vector(R_MH * X_MH_.R.transpose()),
                                   config_.max_turn_rate * config_.translation.Ts),
              .robot = rotation_vector(in.X_MR.R * X_MR_->R.transpose())};
  moves.stretch = rotation_vector(R_MH * in.X_MT.R.transpose() * rotation(-moves.handle));
  const Vec3 r = rotation_->step(moves, in.F_E_M.torque, in.handle.energies.rotation);
  // Made a rotation again each time: hours of ticks would round it away from one.
  return Quat(rotation(r) * in.X_MT.R).normalized().toRotationMatrix();
}

void DirectTarget::tell(SlaveToMaster& out) const noexcept {
  out.energies = {translation_.guard.budget().in(), rotation_ ? rotation_->guard.budget().in() : 0};
}

}  // namespace farhand
