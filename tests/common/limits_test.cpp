#include "common/limits.hpp"

#include <gtest/gtest.h>

namespace farhand {
namespace {

constexpr WrenchLimits kLimits{
    .force = 10, .torque = 1, .twist_torque = 0.2, .force_step = 0.5, .torque_step = 0.05};

TEST(Limits, WrenchIsClampedInItsDirectionAndTwistFirst) {
  LimitSet set = 0;
  const WrenchLimits wide{
      .force = 10, .torque = 1, .twist_torque = 0.2, .force_step = 1e3, .torque_step = 1e3};
  const Wrench F = limit_wrench(wide, {Vec3(30, 40, 0), Vec3(3, 0, 2)}, {}, set);
  EXPECT_NEAR((F.force - Vec3(6, 8, 0)).norm(), 0, 1e-14);
  EXPECT_NEAR(F.torque.norm(), 1, 1e-15);
  EXPECT_NEAR(F.torque.z() / F.torque.x(), 0.2 / 3, 1e-15);
  EXPECT_EQ(set, kLimitForce);
}

TEST(Limits, WrenchChangesByAtMostOneStepPerTick) {
  Wrench last;
  for (int k = 0; k < 100; ++k) {
    LimitSet set = 0;
    const Wrench F =
        limit_wrench(kLimits, {Vec3(0, 0, k < 50 ? 100 : -100), Vec3::Zero()}, last, set);
    EXPECT_LE((F.force - last.force).norm(), 0.5 + 1e-12);
    EXPECT_LE(F.force.norm(), 10 + 1e-12);
    last = F;
  }
}

TEST(Limits, NonFiniteWrenchFadesToZero) {
  LimitSet set = 0;
  const Wrench F =
      limit_wrench(kLimits, {Vec3(NAN, 0, 0), Vec3::Zero()}, {Vec3(2, 0, 0), Vec3::Zero()}, set);
  EXPECT_EQ(F.force, Vec3(1.5, 0, 0));
  EXPECT_TRUE(set & kLimitNotFinite);
}

TEST(Limits, MotorTorquesKeepTheirDirection) {
  LimitSet set = 0;
  const Vec6 tau = (Vec6() << 1, -8, 2, 0, 0, 4).finished();
  const Vec6 out = limit_motor_torques(2, 100, tau, Vec6::Zero(), set);
  EXPECT_NEAR((out - tau / 4).norm(), 0, 1e-15);
  EXPECT_EQ(set, kLimitForce);
}

TEST(Limits, NonFiniteMotorTorqueReleasesTheMotors) {
  LimitSet set = 0;
  const Vec6 tau = Vec6::Constant(INFINITY);
  EXPECT_EQ(limit_motor_torques(2, 0.1, tau, Vec6::Ones(), set), Vec6::Zero());
  EXPECT_EQ(set, kLimitNotFinite);
}

TEST(Limits, NonFiniteJointTorqueKeepsTheLastSoThatTheArmDoesNotDrop) {
  LimitSet set = 0;
  const Vec6 last = Vec6::Constant(3);
  EXPECT_EQ(limit_joint_torques(Vec6::Constant(5), Vec6::Ones(), Vec6::Constant(NAN), last, set),
            last);
  EXPECT_EQ(set, kLimitNotFinite);
}

TEST(Limits, JointTorquesAreClampedThenSlewedPerAxis) {
  LimitSet set = 0;
  const Vec6 out = limit_joint_torques(Vec6::Constant(5), Vec6::Ones(), Vec6::Constant(50),
                                       Vec6::Constant(3), set);
  EXPECT_EQ(out, Vec6::Constant(4));
  EXPECT_EQ(set, kLimitForce | kLimitSlew);
}

}  // namespace
}  // namespace farhand
