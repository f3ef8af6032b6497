#include "slave/force_sensing.hpp"

#include <gtest/gtest.h>

#include "slave/arm.hpp"
#include "slave/sim_arm.hpp"

namespace farhand {
namespace {

TEST(ForceSensing, RemovesBiasAndToolWeightInAnyOrientation) {
  const ForceSensingConfig config{
      .tool_mass = 0.7, .p_ET = Vec3(0.01, -0.02, 0.05), .bias = Vec3(1, -2, 0.5)};
  ForceSensing sensing(config, 0.001);
  for (int k = 0; k < 50; ++k) {
    const Pose X_SE{rotation(Vec3(0.1 * k, -0.07 * k, 0.3)), Vec3::Zero()};
    const Wrench contact{Vec3(k, 2, -3), Vec3(0.1, 0.01 * k, 0)};
    const Vec3 weight(0, 0, -0.7 * 9.81);
    const Wrench carried{-weight, -(X_SE.R * config.p_ET).cross(weight)};
    const Wrench raw = contact + Wrench{X_SE.R * config.bias, Vec3::Zero()} + carried;
    const Wrench F = sensing.step(raw, X_SE);
    EXPECT_NEAR((F.force - contact.force).norm(), 0, 1e-13);
    EXPECT_NEAR((F.torque - contact.torque).norm(), 0, 1e-14);
  }
}

TEST(ForceSensing, RobotAtRestInFreeSpaceFeelsNothing) {
  SimArmConfig robot{.q = kTeleopHome};
  robot.sensor = {.bias_E = {Vec3(0.4, -0.3, 0.2), Vec3::Zero()},
                  .tool_mass_kg = 0.2,
                  .tool_com_E = Vec3(0.01, 0, 0.03)};
  SimArm arm(robot);
  ForceSensing sensing(
      {.tool_mass = 0.2, .p_ET = Vec3(0.01, 0, 0.03), .bias = Vec3(0.4, -0.3, 0.2)}, 0.001);
  const RobotReading reading = arm.read({});
  const Wrench F = sensing.step(reading.F_E_S, arm.truth().X_SE);
  EXPECT_NEAR(F.force.norm(), 0, 1e-13);
  EXPECT_NEAR(F.torque.norm(), 0, 1e-14);
}

TEST(ForceSensing, FilterStartsAtTheFirstReadingAndSettles) {
  ForceSensing sensing({.cutoff_hz = 50}, 0.001);
  EXPECT_EQ(sensing.step({Vec3(3, 0, 0), Vec3::Zero()}, {}).force.x(), 3);
  double last = 3;
  for (int k = 0; k < 100; ++k) {
    const double f = sensing.step({Vec3(5, 0, 0), Vec3::Zero()}, {}).force.x();
    EXPECT_GE(f, last);
    last = f;
  }
  EXPECT_NEAR(last, 5, 1e-9);
}

TEST(ForceSensing, NonFiniteReadingKeepsTheLastValue) {
  ForceSensing sensing({}, 0.001);
  sensing.step({Vec3(1, 0, 0), Vec3::Zero()}, {});
  EXPECT_EQ(sensing.step({Vec3(NAN, 0, 0), Vec3::Zero()}, {}).force, Vec3(1, 0, 0));
}

}  // namespace
}  // namespace farhand
