#include "slave/arm_dynamics.hpp"

#include <gtest/gtest.h>

#include <Eigen/Cholesky>
#include <numbers>

#include "common/random.hpp"

namespace farhand::arm_dynamics_test {
namespace {

constexpr std::uint64_t kSeed = 11;
constexpr double kDegree = std::numbers::pi / 180;

Vec6 draw(Random& random, double limit) {
  Vec6 v;
  for (double& x : v) x = limit * (2 * random.uniform() - 1);
  return v;
}

TEST(ArmDynamics, StretchedLevelArmWeighsOnItsShoulderAsCountedByHand) {
  const ArmDynamics arm = make_arm_dynamics({});
  Vec6 q;
  q << 90, 0, 90, 0, 0, 0;  // stretched along +Y
  const Vec6 tau = gravity_torques(arm, q * kDegree);
  const double moment = 2.2 * 0.125 + 1.2 * 0.31 + 1.0 * 0.39 + 0.5 * 0.49 + 0.4 * 0.56;
  EXPECT_NEAR(tau[0], 0, 1e-14);
  EXPECT_NEAR(tau[1], 9.81 * moment, 1e-13);
  EXPECT_NEAR(tau[3], 0, 1e-14);
  EXPECT_NEAR(std::abs(tau[4]), 9.81 * 0.4 * 0.07, 1e-14);
}

TEST(ArmDynamics, ToolStandsWhereTheReferenceSaysAtHome) {
  Vec6 q;
  q << 90, 95, -35, 0, 30, 0;
  const ArmFrames f = arm_frames(make_arm_dynamics({}), joint_trig(q * kDegree));
  EXPECT_NEAR((f.X_SE.p - Vec3(0, 0.32605716122, 0.38904867452)).norm(), 0, 2e-11);
  EXPECT_NEAR((f.X_SE.R.col(0) - Vec3::UnitZ()).norm(), 0, 1e-15);
  EXPECT_NEAR((f.X_SE.R.col(1) - Vec3::UnitX()).norm(), 0, 1e-15);
}

TEST(ArmDynamics, MassMatrixIsSymmetricPositiveDefinite) {
  const ArmDynamics arm = make_arm_dynamics({});
  Random random(kSeed);
  for (int k = 0; k < 1000; ++k) {
    const Mat6 M = mass_matrix(arm, draw(random, 4));
    EXPECT_EQ(M, M.transpose());
    EXPECT_EQ(M.llt().info(), Eigen::Success) << "seed " << kSeed << " draw " << k;
  }
}

TEST(ArmDynamics, GravityTorquesAreTheSlopeOfThePotential) {
  const ArmDynamics arm = make_arm_dynamics({.gravity = Vec3(1, -2, -9)});
  Random random(kSeed);
  for (int k = 0; k < 100; ++k) {
    const Vec6 q = draw(random, 4), direction = draw(random, 1);
    const double h = 1e-5;
    const double slope = (energy(arm, q + h * direction, Vec6::Zero()) -
                          energy(arm, q - h * direction, Vec6::Zero())) /
                         (2 * h);
    EXPECT_NEAR(gravity_torques(arm, q).dot(direction), slope, 1e-8) << "seed " << kSeed;
  }
}

TEST(ArmDynamics, JointAndToolPowerChangeTheEnergy) {
  const ArmDynamics arm = make_arm_dynamics({});
  Random random(kSeed);
  for (int k = 0; k < 100; ++k) {
    const Vec6 q = draw(random, 3), dq = draw(random, 2), tau = draw(random, 10);
    const Wrench F{Vec3(5, -3, 8), Vec3(0.5, 1, -0.7)};
    const Vec6 ddq = forward_dynamics(arm, q, dq, tau, F);
    const Twist V = tool_twist(arm_frames(arm, joint_trig(q)), dq);
    const double h = 1e-6;
    const auto at = [&](double t) -> double {
      return energy(arm, q + t * dq + t * t / 2 * ddq, dq + t * ddq);
    };
    const double power = tau.dot(dq) + F.force.dot(V.linear) + F.torque.dot(V.angular);
    EXPECT_NEAR((at(h) - at(-h)) / (2 * h), power, 1e-6) << "seed " << kSeed;
  }
}

TEST(ArmDynamics, ForwardDynamicsUndoesMassMatrixAndBias) {
  const ArmDynamics arm = make_arm_dynamics({});
  Random random(kSeed);
  for (int k = 0; k < 1000; ++k) {
    const Vec6 q = draw(random, 4), dq = draw(random, 5), ddq = draw(random, 50);
    const Vec6 tau = mass_matrix(arm, q) * ddq + bias(arm, q, dq);
    EXPECT_NEAR((forward_dynamics(arm, q, dq, tau) - ddq).norm(), 0, 1e-10) << "seed " << kSeed;
  }
}

TEST(ArmDynamics, ToolVelocityAndWrenchAreDualAndVelocityIsTheSlopeOfThePose) {
  const ArmDynamics arm = make_arm_dynamics({});
  Random random(kSeed);
  for (int k = 0; k < 100; ++k) {
    const Vec6 q = draw(random, 4), dq = draw(random, 1);
    const ArmFrames frames = arm_frames(arm, joint_trig(q));
    const Twist V = tool_twist(frames, dq);
    const double h = 1e-6;
    const Pose ahead = arm_frames(arm, joint_trig(q + h * dq)).X_SE,
               behind = arm_frames(arm, joint_trig(q - h * dq)).X_SE;
    EXPECT_NEAR((V.linear - (ahead.p - behind.p) / (2 * h)).norm(), 0, 1e-9);
    EXPECT_NEAR((V.angular - rotation_vector(ahead.R * behind.R.transpose()) / (2 * h)).norm(), 0,
                1e-9);
    const Wrench F{draw(random, 10).head<3>(), draw(random, 10).head<3>()};
    EXPECT_NEAR(joint_torques(frames, F).dot(dq), F.force.dot(V.linear) + F.torque.dot(V.angular),
                1e-13);
  }
}

}  // namespace
}  // namespace farhand::arm_dynamics_test
