#include "master/hand_linkage.hpp"

namespace farhand {
namespace {

// Half of reference sections 2.4 and 5.6.
constexpr double kFalconEdge = 0.05;    // of |det n| and |sin(t1 - t2)|
constexpr double kForearmEdge = 0.075;  // of the forearms' determinant
constexpr double kLeverEdge = 0.01;     // [m]
constexpr double kSinMostTilt =
    0.999;  // 87.4 deg of beta_e, where the handle axes still turn slowly

bool inside(const FalconJacobian& J) noexcept {
  return J.status == Status::ok && J.det_n <= -kFalconEdge && J.min_abs_sin >= kFalconEdge;
}

bool inside(const TwinDeltaJacobian& J) noexcept {
  if (J.status != Status::ok || std::abs(J.R_MG(0, 2)) > kSinMostTilt) return false;
  for (const BarMap& half : J.half)
    if (half.bars.det < kForearmEdge || half.lever.cwiseAbs().minCoeff() < kLeverEdge) return false;
  return true;
}

}  // namespace

bool HandLinkage<FalconGeometry>::solve(const HandState& state) noexcept {
  const FalconJacobian J = jacobian(g_, state.p_MH);
  const FalconMotorAngles angles = motor_angles(g_, state.p_MH);
  if (!inside(J) || angles.status != Status::ok) return false;
  J_ = J;
  theta_.head<3>() = angles.theta1;
  return true;
}

HandLoad HandLinkage<FalconGeometry>::motors(const Vec6& tau) const noexcept {
  return {.force = force(J_, tau.head<3>())};
}

bool HandLinkage<TwinDeltaGeometry>::solve(const HandState& state) noexcept {
  const TwinDeltaPose pose{state.p_MH, state.axis_M, twist_length(g_, state.twist)};
  const TwinDeltaJacobian J = jacobian(g_, pose, handle_axes(state.axis_M, J_.R_MG.col(0)));
  const TwinDeltaMotorAngles angles = motor_angles(g_, pose);
  if (!inside(J) || angles.status != Status::ok) return false;
  J_ = J;
  theta_ = angles.theta1;
  return true;
}

HandLoad HandLinkage<TwinDeltaGeometry>::motors(const Vec6& tau) const noexcept {
  const Wrench F_G = wrench(J_, tau);
  return {.force = J_.R_MG * F_G.force,
          .moment = J_.R_MG * Vec3(F_G.torque.x(), F_G.torque.y(), 0),
          .twist = F_G.torque.z()};
}

}  // namespace farhand
