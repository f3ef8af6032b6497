#include "master/compensation/damped_rotation.hpp"

#include "common/limits.hpp"

namespace farhand {

DampedRotation::DampedRotation(const DampedRotationConfig& c) noexcept
    : tilt_(c.tilt), twist_(c.twist), max_torque_(c.max_torque), port_(c.guard) {}

Vec3 DampedRotation::step(const CouplingInputs& in, double share) noexcept {
  port_.hear(in.robot.energies.rotation);
  const HandlePose& handle = in.handle;
  if (turning_) turned_ += rotation_vector(handle.X_MH.R * R_.transpose());
  turning_ = true;
  R_ = handle.X_MH.R;
  const Vec3 M_M = handle.R_MG * Vec3(share * wanted(in));
  return handle.R_MG.transpose() * port_.step(clamp_norm(M_M, max_torque_), turned_);
}

Vec3 DampedRotation::wanted(const CouplingInputs& in) noexcept {
  const HandlePose& handle = in.handle;
  const Mat3 R_GM = handle.R_MG.transpose();
  Vec3 turn_G = Vec3::Zero();
  if (in.robot.has_robot)
    turn_G = R_GM * rotation_vector(handle.X_MH.R * in.robot.q_MR.toRotationMatrix().transpose());
  const Vec3 rate_G = R_GM * in.V_MH.angular;
  Vec3 out = tilt_.step(turn_G, rate_G, in.robot.F_E_M.torque, in.echo_age);
  out.z() = twist_.step(turn_G, rate_G, in.robot.F_E_M.torque, in.echo_age).z();
  return out;
}

void DampedRotation::let_go() noexcept {
  turning_ = false;
  port_.let_go();
}

}  // namespace farhand
