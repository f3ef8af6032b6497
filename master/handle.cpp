#include "master/handle.hpp"

#include "common/pid.hpp"

namespace farhand {

void FalconHandle::update(const Vec6& theta, HandlePose& pose) noexcept {
  at = at.status == Status::ok ? forward(geometry, theta.head<3>(), at.p_MH)
                               : forward(geometry, theta.head<3>());
  pose.status = at.status;
  if (at.status == Status::ok) pose.X_MH.p = at.p_MH;
}

MotorTorques FalconHandle::torque(const HandlePose&, const Wrench& F_G) const noexcept {
  const FalconJacobian J = jacobian(geometry, at);
  if (!accepted(geometry, J))
    return {.status = J.status == Status::ok ? Status::out_of_limits : J.status};
  MotorTorques out{.status = Status::ok};
  out.tau.head<3>() = farhand::torque(J, F_G.force);
  return out;
}

Wrench FalconHandle::edge_wrench(const HandlePose&, const WorkspaceEdge& edge) const noexcept {
  return {.force = edge_force(geometry, at, jacobian(geometry, at), edge)};
}

void TwinDeltaHandle::update(const Vec6& theta, HandlePose& pose) noexcept {
  solve_forward(geometry, theta, at);
  pose.status = at.status;
  if (at.status != Status::ok) return;
  pose.R_MG = handle_axes(at.pose.axis, pose.R_MG.col(0));
  pose.X_MH.R = handle_rotation(geometry, pose.R_MG, at.pose.length);
  pose.X_MH.p = at.pose.p_MH;
}

MotorTorques TwinDeltaHandle::torque(const HandlePose& pose, const Wrench& F_G) const noexcept {
  const TwinDeltaJacobian J = jacobian(geometry, at, pose.R_MG);
  if (!accepted(geometry, J))
    return {.status = J.status == Status::ok ? Status::out_of_limits : J.status};
  return {.status = Status::ok, .tau = farhand::torque(J, F_G)};
}

Wrench TwinDeltaHandle::edge_wrench(const HandlePose& pose,
                                    const WorkspaceEdge& edge) const noexcept {
  return farhand::edge_wrench(geometry, at, jacobian(geometry, at, pose.R_MG), edge);
}

HandleVelocity::HandleVelocity(double cutoff_hz, double Ts) noexcept
    : gain_per_Ts_(low_pass_gain(cutoff_hz, Ts) / Ts), gain_(low_pass_gain(cutoff_hz, Ts)) {}

const Twist& HandleVelocity::step(const Pose& X_MH) noexcept {
  if (!primed_) last_ = X_MH, V_MH_ = {}, primed_ = true;
  // Between two samples the turn is small: the skew part of the difference is its rotation vector
  // to third order.
  const Mat3 dR = X_MH.R * last_.R.transpose();
  const Vec3 turn(dR(2, 1) - dR(1, 2), dR(0, 2) - dR(2, 0), dR(1, 0) - dR(0, 1));
  V_MH_.linear += gain_per_Ts_ * (X_MH.p - last_.p) - gain_ * V_MH_.linear;
  V_MH_.angular += gain_per_Ts_ * 0.5 * turn - gain_ * V_MH_.angular;
  last_ = X_MH;
  return V_MH_;
}

}  // namespace farhand
