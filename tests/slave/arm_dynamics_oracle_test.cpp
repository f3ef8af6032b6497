// The arm's dynamics against MuJoCo, which forms them independently.
#include <gtest/gtest.h>

#include <cstdio>
#include <numbers>
#include <random>

#include "tests/support/mujoco_arm.hpp"

namespace farhand {
namespace {

constexpr unsigned kSeed = 20220601;

struct Draw {
  std::mt19937_64 generator{kSeed};
  double operator()(double limit) {
    return limit * (2 * static_cast<double>(generator() >> 11) * 0x1p-53 - 1);
  }
  template <typename Vector>
  Vector vector(double limit) {
    Vector v;
    for (auto& x : v) x = (*this)(limit);
    return v;
  }
};

// A robot that shares no number with the default one, and has no COM on an axis.
ArmModel crooked_arm() {
  ArmModel m;
  Draw draw;
  m.gravity = Vec3(1.5, -2.5, -9);
  m.armature = 0.003;
  m.lengths = {.d1 = 0.4, .a2 = 0.31, .d4 = 0.19, .d6 = 0.23};
  for (auto& l : m.links) {
    l.mass = 1.5 + draw(1.0);
    l.com = draw.vector<Vec3>(0.1);
    l.inertia = Vec3(0.01, 0.01, 0.01) + draw.vector<Vec3>(0.004);
  }
  return m;
}

// Worst relative error of ddq (max norm) over random states.
double worst_acceleration_error(const ArmModel& model, int states, bool tool_wrench) {
  const MujocoArm oracle(model);
  const ArmDynamics arm = make_arm_dynamics(model);
  Draw draw;
  double worst = 0;
  for (int k = 0; k < states; ++k) {
    const Vec6 q = draw.vector<Vec6>(std::numbers::pi), dq = draw.vector<Vec6>(5),
               tau = draw.vector<Vec6>(30);
    Wrench F;
    if (tool_wrench) F = {draw.vector<Vec3>(50), draw.vector<Vec3>(5)};
    const Vec6 expected = oracle.accelerations(q, dq, tau, F);
    const Vec6 ddq = forward_dynamics(arm, q, dq, tau, F);
    worst =
        std::max(worst, (ddq - expected).cwiseAbs().maxCoeff() / expected.cwiseAbs().maxCoeff());
  }
  return worst;
}

TEST(ArmDynamicsOracle, AccelerationsEqualMujocosWithoutAToolWrench) {
  const double worst = worst_acceleration_error({}, 10000, false);
  std::printf("ddq, free: worst relative error %.3g over 10^4 states\n", worst);
  EXPECT_LE(worst, 1e-10) << "seed " << kSeed;
}

TEST(ArmDynamicsOracle, AccelerationsEqualMujocosWithAToolWrench) {
  const double worst = worst_acceleration_error({}, 10000, true);
  std::printf("ddq, tool wrench: worst relative error %.3g over 10^4 states\n", worst);
  EXPECT_LE(worst, 1e-10) << "seed " << kSeed;
}

TEST(ArmDynamicsOracle, AccelerationsEqualMujocosForACrookedArmInTiltedGravity) {
  const double worst = worst_acceleration_error(crooked_arm(), 10000, true);
  std::printf("ddq, crooked arm: worst relative error %.3g over 10^4 states\n", worst);
  EXPECT_LE(worst, 1e-10) << "seed " << kSeed;
}

TEST(ArmDynamicsOracle, MassMatrixAndBiasEqualMujocos) {
  double worst_mass = 0, worst_bias = 0;
  for (const ArmModel& model : {ArmModel{}, crooked_arm()}) {
    const MujocoArm oracle(model);
    const ArmDynamics arm = make_arm_dynamics(model);
    Draw draw;
    for (int k = 0; k < 1000; ++k) {
      const Vec6 q = draw.vector<Vec6>(std::numbers::pi), dq = draw.vector<Vec6>(5);
      oracle.accelerations(q, dq, Vec6::Zero(), {});
      const Mat6 M = oracle.mass_matrix();
      const Vec6 b = Vec6::Map(oracle.data->qfrc_bias);
      worst_mass = std::max(
          worst_mass, (mass_matrix(arm, q) - M).cwiseAbs().maxCoeff() / M.cwiseAbs().maxCoeff());
      worst_bias = std::max(worst_bias,
                            (bias(arm, q, dq) - b).cwiseAbs().maxCoeff() / b.cwiseAbs().maxCoeff());
    }
  }
  std::printf("mass matrix: worst relative error %.3g; bias: %.3g\n", worst_mass, worst_bias);
  EXPECT_LE(worst_mass, 1e-13) << "seed " << kSeed;
  EXPECT_LE(worst_bias, 1e-12) << "seed " << kSeed;
}

TEST(ArmDynamicsOracle, ToolFrameEqualsMujocos) {
  const ArmModel model = crooked_arm();
  const MujocoArm oracle(model);
  const ArmDynamics arm = make_arm_dynamics(model);
  Draw draw;
  for (int k = 0; k < 1000; ++k) {
    const Vec6 q = draw.vector<Vec6>(std::numbers::pi);
    oracle.accelerations(q, Vec6::Zero(), Vec6::Zero(), {});
    const ArmFrames frames = arm_frames(arm, joint_trig(q));
    const Mat3 R = Eigen::Map<Eigen::Matrix<double, 3, 3, Eigen::RowMajor>>(oracle.data->site_xmat);
    EXPECT_LE((frames.X_SE.p - Vec3::Map(oracle.data->site_xpos)).norm(), 1e-14)
        << "seed " << kSeed;
    EXPECT_LE((frames.X_SE.R - R).norm(), 1e-14) << "seed " << kSeed;
  }
}

}  // namespace
}  // namespace farhand
