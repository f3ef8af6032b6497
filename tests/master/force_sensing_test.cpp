#include "master/force_sensing.hpp"

#include <gtest/gtest.h>

#include "master/sim_hand.hpp"

namespace farhand {
namespace {

TwinDeltaJacobian tilted(double alpha, double beta, double length) {
  const TwinDeltaPose pose{.axis = axis_from_angles(alpha, beta), .length = length};
  return jacobian(kTwinDelta, pose, handle_axes(pose.axis));
}

TEST(HandleForceSensing, RemovesBiasAndTheGripsWeightInAnyOrientation) {
  const HandleForceSensingConfig config{.bias = {Vec3(0.5, -1, 0.2), Vec3(0.1, 0.3, -0.7)},
                                        .grip_mass = 0.3};
  HandleForceSensing sensing(config);
  for (int k = 0; k < 40; ++k) {
    const TwinDeltaJacobian J = tilted(0.02 * k, 0.5 - 0.02 * k, 0.15 + 0.001 * k);
    const Wrench F_user_G{Vec3(k, 2, -3), Vec3(0.1, 0.01 * k, -0.05)};
    const Wrench weight_G{J.R_MG.transpose() * Vec3(0, 0, -0.3 * 9.81), Vec3::Zero()};
    EndForces raw = end_forces(J, F_user_G + weight_G);
    raw.f_E1_M += config.bias.f_E1_M;
    raw.f_E2_A2 += config.bias.f_E2_A2;
    const Wrench F = sensing.step(raw, J);
    EXPECT_NEAR((F.force - F_user_G.force).norm(), 0, 1e-13);
    EXPECT_NEAR((F.torque - F_user_G.torque).norm(), 0, 1e-14);
  }
}

TEST(HandleForceSensing, AHandleThatNobodyHoldsFeelsNothing) {
  const EndForces bias{Vec3(0.2, -0.1, 0.3), Vec3(-0.2, 0.1, 0.15)};
  SimHand<TwinDeltaGeometry> device(
      kTwinDelta, {.encoder_step = 0, .force_noise = 0, .sensor_bias = bias, .grip_mass = 0.15});
  HandleForceSensing sensing({.bias = bias, .grip_mass = 0.15});
  const HandleReading reading = device.read({});
  const TwinDeltaForward at = forward(kTwinDelta, reading.theta);
  const Wrench F = sensing.step(reading.ends, jacobian(kTwinDelta, at, handle_axes(at.pose.axis)));
  EXPECT_NEAR(F.force.norm(), 0, 1e-12);
  EXPECT_NEAR(F.torque.norm(), 0, 1e-13);
}

TEST(HandleForceSensing, AReadingThatIsNotFiniteKeepsTheLastWrench) {
  HandleForceSensing sensing({});
  const TwinDeltaJacobian J = tilted(0, 0, 0.17);
  const Wrench F = sensing.step({Vec3(1, 2, 3), Vec3::Zero()}, J);
  ASSERT_GT(F.force.norm(), 1);
  EXPECT_EQ(sensing.step({Vec3(NAN, 0, 0), Vec3::Zero()}, J).force, F.force);
  EXPECT_EQ(sensing.step({Vec3::Zero(), Vec3(0, INFINITY, 0)}, J).torque, F.torque);
  EXPECT_EQ(sensing.step({Vec3::Zero(), Vec3::Zero()}, TwinDeltaJacobian{}).force, F.force);
}

}  // namespace
}  // namespace farhand
