#include "slave/joint_servo.hpp"

#include <gtest/gtest.h>

#include <numbers>

#include "slave/arm.hpp"

namespace farhand {
namespace {

const JointLimits kJoints;
const Vec6& kSpeed = kJoints.speed;

TEST(JointServo, GravityCompensationCarriesTheArmWithoutAnError) {
  const ArmModel model;
  JointServo with({.gravity_compensation = true}, model, kJoints, 0.001),
      without({}, model, kJoints, 0.001);
  const Vec6 tau = with.step(kTeleopHome, kTeleopHome);
  EXPECT_NEAR((tau - gravity_torques(make_arm_dynamics(model), kTeleopHome)).norm(), 0, 1e-12);
  EXPECT_EQ(without.step(kTeleopHome, kTeleopHome), Vec6::Zero());
}

TEST(JointServo, PushesTowardsTheCommandInProportion) {
  JointServo servo({.integral_per_s = 0}, {}, kJoints, 0.001);
  servo.step(kTeleopHome, kTeleopHome);
  const Vec6 ahead = kTeleopHome + Vec6::Constant(0.001);
  const Vec6 tau = servo.step(ahead, kTeleopHome);
  const double w = 2 * std::numbers::pi * 6;
  for (int i = 0; i < 6; ++i)
    EXPECT_NEAR(tau[i], JointServoConfig{}.inertia[i] * w * w * 0.001, 1e-12);
}

TEST(JointServo, TellsWhenAJointsLargestSpeedHoldsItBack) {
  JointServo servo({}, {}, kJoints, 0.001);
  for (const auto& [ahead, held_back] : {std::pair(0.001, false), {1., true}, {0.001, false}}) {
    for (int k = 0; k < 50; ++k) servo.step(kTeleopHome + Vec6::Constant(ahead), kTeleopHome);
    EXPECT_EQ(servo.held_back(), held_back) << ahead;
  }
}

TEST(JointServo, VelocityFeedforwardCancelsTheServosOwnDamping) {
  JointServo servo({.integral_per_s = 0, .velocity_feedforward = VelocityFeedforwardConfig{}}, {},
                   kJoints, 0.001);
  Vec6 tau;
  for (int k = 0; k < 2000; ++k) {
    const Vec6 q = Vec6::Constant(0.0002 * k);  // a joint exactly on a command that moves steadily
    tau = servo.step(q, q);
  }
  EXPECT_NEAR(tau.norm(), 0, 1e-9);
}

TEST(JointServo, FrictionCompensationFollowsTheCommandedDirection) {
  const ArmModel model;
  JointServo servo({.integral_per_s = 0, .friction_compensation = FrictionCompensationConfig{}},
                   model, kJoints, 0.001);
  const JointServoConfig config;
  Vec6 tau;
  for (int k = 0; k < 2000; ++k) {
    const Vec6 q = Vec6::Constant(-0.0005 * k);
    tau = servo.step(q, q);
  }
  for (int i = 0; i < 6; ++i) {
    const double damping =
        2 * config.damping_ratio * 2 * std::numbers::pi * config.bandwidth_hz * config.inertia[i];
    EXPECT_NEAR(tau[i], -(model.links[i].coulomb + 0.5 * model.links[i].viscous) + 0.5 * damping,
                1e-6)
        << i;
  }
}

// Driven past its limit by what a fast motion wound up, it does not stay there.
TEST(JointServo, AJointBeyondItsLimitLosesTheIntegralThatPushesItFurther) {
  JointServo servo({}, {}, kJoints, 0.001);
  const auto at_rest = [&](double q4) {
    const Vec6 q = Vec6::Unit(3) * q4;
    for (int k = 0; k < 100; ++k) servo.step(q, q);
    return servo.step(q, q)[3];
  };
  for (int k = 0; k < 1000; ++k) servo.step(Vec6::Unit(3) * 0.1, Vec6::Zero());
  const double wound = at_rest(0);
  EXPECT_GT(wound, 5);
  EXPECT_EQ(at_rest(kJoints.upper[3] + 0.001), wound);  // as near as encoders tell
  EXPECT_EQ(at_rest(kJoints.lower[3] - 0.01), wound);   // it pushes back
  EXPECT_EQ(at_rest(kJoints.upper[3] + 0.01), 0);
}

TEST(JointServo, NeverExceedsTheModelsTorqueLimits) {
  const ArmModel model;
  JointServo servo({.gravity_compensation = true}, model, kJoints, 0.001);
  Vec6 tau;
  for (int k = 0; k < 50; ++k) tau = servo.step(kTeleopHome + Vec6::Constant(2), kTeleopHome);
  for (int i = 0; i < 6; ++i) EXPECT_LE(std::abs(tau[i]), model.links[i].torque_limit);
  EXPECT_TRUE(servo.saturated());
  servo.reset();
  EXPECT_FALSE(servo.saturated());
}

// A joint of nominal inertia whose command turns round at full speed again and again.
TEST(JointServo, ACommandThatTurnsRoundAtFullSpeedDoesNotThrowTheJointBeyondIt) {
  constexpr double Ts = 0.001;
  for (const bool fed : {false, true}) {
    JointServoConfig config;
    if (fed) config.velocity_feedforward = VelocityFeedforwardConfig{};
    const double J = config.inertia[3], speed = kSpeed[3];
    JointServo servo(config, {}, kJoints, Ts);
    Vec6 q_cmd = Vec6::Zero(), q = Vec6::Zero();
    double dq = 0, fastest = 0;
    servo.step(q_cmd, q);
    for (int k = 0; k < 3000; ++k) {
      q_cmd[3] += (k % 300 < 150 ? speed : -speed) * Ts;
      dq += Ts * servo.step(q_cmd, q)[3] / J;
      q[3] += Ts * dq;
      fastest = std::max(fastest, std::abs(dq));
    }
    std::printf("to and fro, velocity feed-forward %d: at most %.3f of the speed limit\n", fed,
                fastest / speed);
    EXPECT_LE(fastest, 1.05 * speed);  // without feed-forward the integral adds
    EXPECT_GT(fastest, 0.5 * speed);
  }
}

TEST(JointServo, ItsPredictedErrorIsThatOfASimulatedJoint) {
  const JointServoConfig config;
  const double w = 2 * std::numbers::pi * 0.4, Ts = 0.001, J = config.inertia[0];
  const Pid pid = make_pid(joint_gains(config, J, 1e9), Ts);
  PidState state;
  double q = 0, dq = 0, peak = 0;
  for (int k = 0; k < 30000; ++k) {
    const double r = std::sin(w * Ts * k);
    if (k > 20000) peak = std::max(peak, std::abs(r - q));
    dq += Ts * step(pid, state, r, q) / J;
    q += Ts * dq;
  }
  EXPECT_NEAR(peak, std::abs(servo_error(config, w)), 0.01 * peak);
}

}  // namespace
}  // namespace farhand
