#include "master/handle.hpp"

#include "common/pid.hpp"

namespace farhand {

void FalconHandle::update(const Vec6& theta, HandlePose& pose) noexcept {
  at = at.status == Status::ok ? forward(geometry, theta.head<3>(), at.p_MH)
                               : forward(geometry, theta.head<3>());
  pose.status = at.status;
  if (at.status == Status::ok) pose.X_MH.p = at.p_MH;
}

Status FalconHandle::map_forces(const HandlePose&) noexcept {
  J = jacobian(geometry, at);
  return J.status != Status::ok || accepted(geometry, J) ? J.status : Status::out_of_limits;
}

Vec6 FalconHandle::torque(const Wrench& F_G) const noexcept {
  Vec6 tau = Vec6::Zero();
  tau.head<3>() = farhand::torque(J, F_G.force);
  return tau;
}

Wrench FalconHandle::wrench(const Vec6& tau) const noexcept {
  return {.force = force(J, tau.head<3>())};
}

Wrench FalconHandle::edge_wrench(const WorkspaceEdge& edge) const noexcept {
  return {.force = edge_force(geometry, at, J, edge)};
}

void TwinDeltaHandle::update(const Vec6& theta, HandlePose& pose) noexcept {
  solve_forward(geometry, theta, at);
  pose.status = at.status;
  if (at.status != Status::ok) return;
  pose.R_MG = handle_axes(at.pose.axis, pose.R_MG.col(0));
  pose.twist = twist_angle(geometry, at.pose.length);
  pose.X_MH.R = handle_rotation(geometry, pose.R_MG, at.pose.length);
  pose.X_MH.p = at.pose.p_MH;
}

Status TwinDeltaHandle::map_forces(const HandlePose& pose) noexcept {
  J = jacobian(geometry, at, pose.R_MG);
  return J.status != Status::ok || accepted(geometry, J) ? J.status : Status::out_of_limits;
}

Vec6 TwinDeltaHandle::torque(const Wrench& F_G) const noexcept {
  return farhand::torque(J, F_G);
}

Wrench TwinDeltaHandle::wrench(const Vec6& tau) const noexcept {
  return farhand::wrench(J, tau);
}

Wrench TwinDeltaHandle::edge_wrench(const WorkspaceEdge& edge) const noexcept {
  return farhand::edge_wrench(geometry, at, J, edge);
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
