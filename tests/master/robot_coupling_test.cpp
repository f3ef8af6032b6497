#include "master/robot_coupling.hpp"

#include <gtest/gtest.h>

namespace farhand {
namespace {

constexpr RobotCouplingConfig kConfig{.stiffness = 400,
                                      .damping = 8,
                                      .rotation_stiffness = 2,
                                      .rotation_damping = 0.1,
                                      .twist_stiffness = 0.5,
                                      .twist_damping = 0.02};

HandlePose handle_at(const Vec3& p, const Mat3& R_MG) {
  return {.status = Status::ok, .X_MH = {R_MG, p}, .R_MG = R_MG};
}

TEST(RobotCoupling, PullsTheHandleToTheRobotInHandleAxes) {
  const Mat3 R_MG = rotation(Vec3(0.4, -0.3, 0));
  SlaveToMaster robot{.has_robot = true, .p_MR = Vec3(0.19, 0.01, 0), .q_MR = to_quat(R_MG)};
  robot.V_MR.linear = {0, 0, 0.1};
  const Wrench F = couple(kConfig, handle_at({0.2, 0.01, 0}, R_MG), {}, robot);
  EXPECT_NEAR((R_MG * F.force - Vec3(400 * 0.01, 0, -8 * 0.1)).norm(), 0, 1e-14);
  EXPECT_NEAR(F.torque.norm(), 0, 1e-15);
}

TEST(RobotCoupling, TwistHasASpringOfItsOwn) {
  const Mat3 R_MG = rotation(Vec3(0.2, 0.1, 0)), R_MH = R_MG * rotation(Vec3(0, 0, 0.05));
  HandlePose handle = handle_at({0, 0, 0}, R_MG);
  handle.X_MH.R = R_MH;
  const SlaveToMaster robot{.has_robot = true, .q_MR = to_quat(R_MG)};
  const Wrench twist = couple(kConfig, handle, {}, robot);
  EXPECT_NEAR((twist.torque - Vec3(0, 0, 0.5 * 0.05)).norm(), 0, 1e-15);
  handle.X_MH.R = R_MG * rotation(Vec3(0.05, 0, 0));
  EXPECT_NEAR((couple(kConfig, handle, {}, robot).torque - Vec3(2 * 0.05, 0, 0)).norm(), 0, 1e-15);
  const Twist turning{.angular = R_MG * Vec3(0, 0, 1)};
  EXPECT_NEAR(couple(kConfig, handle_at({0, 0, 0}, R_MG), turning, robot).torque.z(), 0.02, 1e-15);
}

TEST(RobotCoupling, NothingWithoutTheRobotsPose) {
  const Wrench F = couple(kConfig, handle_at({0.2, 0, 0}, Mat3::Identity()), {}, SlaveToMaster{});
  EXPECT_EQ(F.force, Vec3::Zero());
  EXPECT_EQ(F.torque, Vec3::Zero());
}

}  // namespace
}  // namespace farhand
