#include "master/robot_coupling.hpp"

namespace farhand {

Wrench couple(const RobotCouplingConfig& c, const HandlePose& handle, const Twist& V_MH,
              const SlaveToMaster& robot) noexcept {
  if (!robot.has_robot) return {};
  const Mat3 R_GM = handle.R_MG.transpose();
  const Vec3 stretch = handle.X_MH.p - robot.p_MR;
  const Vec3 turn_G =
      R_GM * rotation_vector(handle.X_MH.R * robot.q_MR.toRotationMatrix().transpose());
  const Vec3 rate_G = R_GM * (V_MH.angular - robot.V_MR.angular);
  const Vec3 k(c.rotation_stiffness, c.rotation_stiffness, c.twist_stiffness);
  const Vec3 b(c.rotation_damping, c.rotation_damping, c.twist_damping);
  return {.force = R_GM * (c.stiffness * stretch + c.damping * (V_MH.linear - robot.V_MR.linear)),
          .torque = k.cwiseProduct(turn_G) + b.cwiseProduct(rate_G)};
}

}  // namespace farhand
