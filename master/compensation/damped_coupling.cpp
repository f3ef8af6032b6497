#include "master/compensation/damped_coupling.hpp"

#include "common/limits.hpp"

namespace farhand {

DampedCoupling::DampedCoupling(const DampedCouplingConfig& c) noexcept
    : rotates_(c.rotation),
      max_force_(c.max_force),
      max_torque_(c.max_torque),
      Ts_(c.guard.Ts),
      spring_(c.translation),
      tilt_(c.tilt),
      twist_(c.twist),
      translation_(c.guard),
      rotation_(c.rotation_guard) {}

Wrench DampedCoupling::step(const HandlePose& handle, const Twist& V_MH, const SlaveToMaster& robot,
                            Duration echo_age, double age_share) noexcept {
  const double share = fade_in_.step(age_share, Ts_);
  translation_.hear(robot.energies.translation);
  rotation_.hear(robot.energies.rotation);
  const Vec3 stretch = robot.has_robot ? Vec3(handle.X_MH.p - robot.p_MR) : Vec3::Zero();
  const Vec3 F_M = share * spring_.step(stretch, V_MH.linear, robot.F_E_M.force, echo_age);
  const Mat3 R_GM = handle.R_MG.transpose();
  Wrench F_G{.force = R_GM * translation_.step(clamp_norm(F_M, max_force_), handle.X_MH.p)};
  if (!rotates_) return F_G;

  if (turning_) turned_ += rotation_vector(handle.X_MH.R * R_.transpose());
  turning_ = true;
  R_ = handle.X_MH.R;
  const Vec3 wanted = share * torque(handle, V_MH, robot, echo_age);
  F_G.torque = R_GM * rotation_.step(clamp_norm(Vec3(handle.R_MG * wanted), max_torque_), turned_);
  return F_G;
}

Vec3 DampedCoupling::torque(const HandlePose& handle, const Twist& V_MH, const SlaveToMaster& robot,
                            Duration echo_age) noexcept {
  const Mat3 R_GM = handle.R_MG.transpose();
  Vec3 turn_G = Vec3::Zero();
  if (robot.has_robot)
    turn_G = R_GM * rotation_vector(handle.X_MH.R * robot.q_MR.toRotationMatrix().transpose());
  const Vec3 rate_G = R_GM * V_MH.angular;
  Vec3 out = tilt_.step(turn_G, rate_G, robot.F_E_M.torque, echo_age);
  out.z() = twist_.step(turn_G, rate_G, robot.F_E_M.torque, echo_age).z();
  return out;
}

void DampedCoupling::let_go() noexcept {
  turning_ = false;
  translation_.let_go();
  rotation_.let_go();
}

}  // namespace farhand
