#include "master/sim_hand.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <chrono>
#include <cmath>
#include <cstdio>

#include "tests/support/allocations.hpp"
#include "tests/support/temporary_file.hpp"

namespace farhand {
namespace {

using namespace std::chrono_literals;

constexpr TimePoint kStart{1234567s};  // any: only differences count

template <typename Geometry>
SimHand<Geometry> hand(SimHandConfig config = {}) {
  return SimHand<Geometry>(Geometry{}, std::move(config));
}

// Reads every millisecond without torque and returns the last reading.
template <typename Geometry>
HandleReading idle(SimHand<Geometry>& device, double from, double until) {
  HandleReading reading;
  for (double t = from; t < until + 5e-4; t += 1e-3) {
    reading = device.read(kStart + from_seconds(t));
    device.write(kStart + from_seconds(t) + 300us, Vec6::Zero());
  }
  return reading;
}

SimHandConfig quiet() {
  return {.user = OperatorConfig{}, .encoder_step = 0, .force_noise = 0};
}

// What the sensors read, as a wrench of the user at the handle.
Wrench felt(const HandleReading& reading) {
  const TwinDeltaForward at = forward(TwinDeltaGeometry{}, reading.theta);
  return wrench(jacobian(TwinDeltaGeometry{}, at, handle_axes(at.pose.axis)), reading.ends);
}

// ---- the plant behind the seam

TEST(SimHand, TheWeightSagsIntoTheHandsSpring) {
  auto device = hand<TwinDeltaGeometry>(quiet());
  const HandleReading reading = idle(device, 0, 10);
  EXPECT_LT((device.truth().state.p_MH - Vec3(0.18, 0, -2.0 / 500)).norm(), 1e-9);
  EXPECT_LT((felt(reading).force - Vec3(0, 0, 2)).norm(), 1e-6);
  const TwinDeltaForward at = forward(TwinDeltaGeometry{}, reading.theta);
  EXPECT_LT((at.pose.p_MH - device.truth().state.p_MH).norm(), 1e-12);
}

TEST(SimHand, TheFalconsWeightPullsDownItsOwnVertical) {
  SimHandConfig config = quiet();
  config.device.weight = 2.943;
  auto device = hand<FalconGeometry>(config);
  idle(device, 0, 10);
  EXPECT_LT((device.truth().state.p_MH - Vec3(0, -2.943 / 500, 0.120)).norm(), 1e-9);
}

TEST(SimHand, MotorsPushTheHandleAgainstTheHandsSpring) {
  SimHandConfig config = quiet();
  config.device.weight = 0;
  auto device = hand<TwinDeltaGeometry>(config);
  const Wrench F_G{.force = {2, 1, -1}, .torque = {0.1, -0.05, 0.02}};
  for (int k = 0; k < 10000; ++k) {
    const TimePoint now = kStart + k * 1ms;
    const TwinDeltaForward at = forward(TwinDeltaGeometry{}, device.read(now).theta);
    const Mat3 R_MG = handle_axes(at.pose.axis);
    device.write(now + 300us, torque(jacobian(TwinDeltaGeometry{}, at, R_MG), F_G));
  }
  const HandTruth& truth = device.truth();
  EXPECT_LT(
      (truth.state.p_MH - Vec3(0.18, 0, 0) - handle_axes(truth.state.axis_M) * F_G.force / 500)
          .norm(),
      1e-6);
  EXPECT_NEAR(truth.state.twist, 0.02 / 0.5, 1e-6);
  const Wrench F_user_G = felt(device.read(kStart + 10s));
  EXPECT_LT((F_user_G.force + F_G.force).norm(), 1e-4);
  EXPECT_LT((F_user_G.torque + F_G.torque).norm(), 1e-5);
}

TEST(SimHand, TheHandFollowsItsMotion) {
  SimHandConfig config = quiet();
  config.user->motion.sines = {{.frequency = 0.5, .offset = {0.02, 0, 0}, .turn = {0, 0.3, 0.4}}};
  config.user->impedance.stiffness = 2000;
  config.device = {.friction = 0, .weight = 0, .rotation_friction = 0};
  auto device = hand<TwinDeltaGeometry>(config);
  double largest = 0, largest_turn = 0, largest_twist = 0;
  for (int k = 0; k < 8000; ++k) {
    device.read(kStart + k * 1ms);
    const HandTruth& truth = device.truth();
    largest = std::max(largest, (truth.state.p_MH - truth.wish.p.x).norm());
    largest_turn = std::max(largest_turn, (truth.state.axis_M - truth.wish.axis.x).norm());
    largest_twist = std::max(largest_twist, std::abs(truth.state.twist - truth.wish.twist.x));
  }
  EXPECT_LT(largest, 0.5e-3);
  EXPECT_LT(largest_turn, 0.03);
  EXPECT_LT(largest_twist, 0.03);
  EXPECT_EQ(device.truth().stops, 0u);
}

TEST(SimHand, TheHandTurnsBesidesItsMotionWhenTold) {
  auto device = hand<TwinDeltaGeometry>(quiet());
  idle(device, 0, 1);
  device.turn(Vec3(0.2, 0, -0.1));
  idle(device, 1, 2);
  device.turn(Vec3::Zero());
  idle(device, 2, 5);
  const HandTruth& truth = device.truth();
  EXPECT_LT((truth.wish.axis.x - Vec3(0, -std::sin(0.2), std::cos(0.2))).norm(), 1e-3);
  EXPECT_LT((truth.state.axis_M - truth.wish.axis.x).norm(), 1e-3);
  EXPECT_NEAR(truth.state.twist, -0.1, 1e-3);
}

TEST(SimHand, NobodyHoldsAndTheHandleSinksToTheEdgeAndRests) {
  SimHandConfig config;
  config.device.friction = 0;
  auto device = hand<TwinDeltaGeometry>(config);
  idle(device, 0, 3);
  const HandTruth& truth = device.truth();
  EXPECT_GT(truth.stops, 0u);
  EXPECT_LT(truth.state.p_MH.z(), -0.05);
  EXPECT_LT(truth.state.v_MH.norm(), 0.01);
  EXPECT_TRUE(truth.theta.allFinite());
  EXPECT_EQ(truth.user.force, Vec3::Zero());
}

TEST(SimHand, AnImpossibleWishEndsAtTheEdgeWithAnglesThatSolve) {
  SimHandConfig config = quiet();
  config.user->motion.reaches = {{.at = 0.2, .lasting = 1, .by = {0.1, 0.15, 0.05}},
                                 {.at = 2, .lasting = 2, .turn = {1.5, 1.2, 9}},
                                 {.at = 5, .lasting = 2, .by = {-0.2, -0.2, 0}}};
  config.user->motion.limits = {.speed = 3, .turn_rate = 10};
  auto device = hand<TwinDeltaGeometry>(config);
  for (double t = 0; t < 8; t += 1e-3) {
    const HandleReading reading = idle(device, t, t);
    ASSERT_EQ(forward(TwinDeltaGeometry{}, reading.theta).status, Status::ok) << t;
    ASSERT_LE(std::abs(device.truth().state.twist), 3.1416) << t;
  }
  EXPECT_GT(device.truth().stops, 10u);
}

TEST(SimHand, AtTheEdgeTheHandleSlidesAlong) {
  SimHandConfig config = quiet();
  config.device.weight = 0;
  config.user->motion.reaches = {{.at = 0.2, .by = {0, 0.2, 0}},
                                 {.at = 2, .lasting = 2, .by = {0, 0, 0.08}}};
  auto device = hand<TwinDeltaGeometry>(config);
  idle(device, 0, 1.9);
  ASSERT_GT(device.truth().stops, 0u);
  const double before = device.truth().state.p_MH.z();
  idle(device, 1.9, 6);
  EXPECT_GT(device.truth().state.p_MH.z(), before + 0.02);
}

// ---- time

TEST(SimHand, SubstepsDoNotDependOnHowOftenItIsCalled) {
  SimHandConfig config = quiet();
  config.user->motion.sines = {
      {.frequency = 0.7, .offset = {0.02, 0.01, 0}, .turn = {0.2, 0, 0.3}}};
  auto often = hand<TwinDeltaGeometry>(config), rarely = hand<TwinDeltaGeometry>(config);
  for (int k = 0; k <= 3000; ++k) often.read(kStart + k * 1ms);
  for (int k = 0; k <= 150; ++k) rarely.read(kStart + k * 20ms);
  EXPECT_LT((often.truth().state.p_MH - rarely.truth().state.p_MH).norm(), 1e-6);
  EXPECT_LT((often.truth().state.axis_M - rarely.truth().state.axis_M).norm(), 1e-5);
  EXPECT_EQ(often.truth().t, 3);
  EXPECT_EQ(rarely.truth().skipped, 0u);
}

TEST(SimHand, NothingMovesWithoutTime) {
  auto device = hand<TwinDeltaGeometry>(quiet());
  idle(device, 0, 0.2);
  const HandState before = device.truth().state;
  const double t = device.truth().t;
  for (int i = 0; i < 100; ++i) device.read(kStart + 200ms);
  device.write(kStart + 100ms, Vec6::Constant(0.1));  // the past
  EXPECT_EQ(device.truth().state.p_MH, before.p_MH);
  EXPECT_EQ(device.truth().t, t);
}

TEST(SimHand, ALateCallCatchesUpFiftyMillisecondsAndCountsTheRest) {
  auto device = hand<FalconGeometry>(quiet());
  device.read(kStart);
  device.read(kStart + 50ms);
  EXPECT_EQ(device.truth().skipped, 0u);
  EXPECT_DOUBLE_EQ(device.truth().t, 0.05);
  device.read(kStart + 10s);
  EXPECT_EQ(device.truth().skipped, 1u);
  EXPECT_DOUBLE_EQ(device.truth().t, 0.1);
  device.read(kStart + 10s + 1ms);
  EXPECT_DOUBLE_EQ(device.truth().t, 0.101);
}

// ---- torques, encoders, sensor, buttons

TEST(SimHand, TorquesBeyondTheMotorsAreScaledAsAWhole) {
  SimHandConfig config = quiet();
  config.max_motor_torque = 0.9;
  auto device = hand<FalconGeometry>(config);
  device.write(kStart, (Vec6() << 0.3, -1.8, 0.6, 50, 0, 0).finished());
  EXPECT_LT((device.truth().tau - (Vec6() << 0.15, -0.9, 0.3, 0, 0, 0).finished()).norm(), 1e-15);
  EXPECT_EQ(device.truth().saturated, 1u);
  device.write(kStart, Vec6::Constant(0.5));
  EXPECT_EQ(device.truth().saturated, 1u);
}

TEST(SimHand, MotorsMayGiveMoreThanTheyAreTold) {
  SimHandConfig config = quiet();
  config.max_motor_torque = 0.9;
  config.motor_gain = 1.5;
  auto device = hand<FalconGeometry>(config);
  device.write(kStart, (Vec6() << 0.2, -0.4, 0, 0, 0, 0).finished());
  EXPECT_LT((device.truth().tau - (Vec6() << 0.3, -0.6, 0, 0, 0, 0).finished()).norm(), 1e-15);
  EXPECT_EQ(device.truth().saturated, 0u);
  device.write(kStart, (Vec6() << 0.4, -0.8, 0, 0, 0, 0).finished());
  EXPECT_LT((device.truth().tau - (Vec6() << 0.45, -0.9, 0, 0, 0, 0).finished()).norm(), 1e-15);
  EXPECT_EQ(device.truth().saturated, 1u);
}

TEST(SimHand, ATorqueThatIsNotFiniteIsZeroAndCounted) {
  auto device = hand<TwinDeltaGeometry>(quiet());
  device.write(kStart, Vec6::Constant(0.5));
  Vec6 tau = Vec6::Zero();
  tau[4] = NAN;
  device.write(kStart + 1ms, tau);
  EXPECT_EQ(device.truth().tau, Vec6::Zero());
  EXPECT_EQ(device.truth().bad_torque, 1u);
  tau[4] = INFINITY;
  device.write(kStart + 2ms, tau);
  EXPECT_EQ(device.truth().bad_torque, 2u);
  EXPECT_TRUE(device.read(kStart + 3ms).theta.allFinite());
}

TEST(SimHand, EncodersReadWholeStepsNearestToTheTruth) {
  SimHandConfig config = quiet();
  config.encoder_step = 1.3e-4;
  config.user->motion.sines = {{.frequency = 1, .offset = {0.02, 0, 0}}};
  auto device = hand<TwinDeltaGeometry>(config);
  for (int k = 0; k < 2000; ++k) {
    const Vec6 theta = device.read(kStart + k * 1ms).theta;
    for (int i = 0; i < 6; ++i) {
      ASSERT_EQ(theta[i], 1.3e-4 * std::round(theta[i] / 1.3e-4));
      ASSERT_LE(std::abs(theta[i] - device.truth().theta[i]), 0.65e-4 * (1 + 1e-9));
    }
  }
  auto ideal = hand<TwinDeltaGeometry>(quiet());
  EXPECT_EQ(ideal.read(kStart).theta, ideal.truth().theta);
}

TEST(SimHand, TheForceSensorsNoiseHasItsStatisticsAndIsRepeatable) {
  SimHandConfig config = quiet();
  config.force_noise = 0.03;
  config.seed = 42;
  auto device = hand<TwinDeltaGeometry>(config), same = hand<TwinDeltaGeometry>(config);
  config.seed = 43;
  auto other = hand<TwinDeltaGeometry>(config);
  const int n = 20000;
  Vec6 sum = Vec6::Zero(), square = Vec6::Zero();
  int equal = 0;
  for (int i = 0; i < n; ++i) {  // no time passes: nothing but noise
    const EndForces ends = device.read(kStart).ends;
    ASSERT_EQ(ends.f_E2_A2, same.read(kStart).ends.f_E2_A2);
    equal += ends.f_E1_M == other.read(kStart).ends.f_E1_M;
    Vec6 x;
    x << ends.f_E1_M, ends.f_E2_A2;
    sum += x / 0.03;
    square += (x / 0.03).cwiseAbs2();
  }
  EXPECT_EQ(equal, 0);
  EXPECT_LT((sum / n).cwiseAbs().maxCoeff(), 0.03) << "seed 42";
  EXPECT_LT((square / n - Vec6::Ones()).cwiseAbs().maxCoeff(), 0.05) << "seed 42";
}

TEST(SimHand, TheForceSensorsCarryTheGripAndHaveABias) {
  SimHandConfig config = quiet();
  config.sensor_bias = {Vec3(0.1, -0.2, 0.3), Vec3(-0.4, 0.5, 0.6)};
  config.grip_mass = 0.2;
  auto device = hand<TwinDeltaGeometry>(config);
  const EndForces ends = device.read(kStart).ends;
  const Vec3 half_M = -0.1 * 9.81 * Vec3::UnitZ();  // the lower sensor's z points down
  EXPECT_LT((ends.f_E1_M - config.sensor_bias.f_E1_M - half_M).norm(), 1e-12);
  EXPECT_LT((ends.f_E2_A2 - config.sensor_bias.f_E2_A2 + half_M).norm(), 1e-12);
}

TEST(SimHand, OnlyARotatingHandleWithItsSensorReportsForce) {
  EXPECT_TRUE(hand<TwinDeltaGeometry>().read(kStart).has_force);
  EXPECT_FALSE(hand<TwinDeltaGeometry>({.force_sensor = false}).read(kStart).has_force);
  EXPECT_FALSE(hand<FalconGeometry>().read(kStart).has_force);
}

TEST(SimHand, ButtonsFollowTheirScript) {
  auto device = hand<FalconGeometry>();  // the dead-man at 0.5 s, held
  EXPECT_FALSE(idle(device, 0, 0.45).dead_man);
  EXPECT_TRUE(idle(device, 0.45, 0.6).dead_man);
  EXPECT_FALSE(idle(device, 0.6, 0.7).clutch);
  SimHandConfig config;
  config.presses = {
      {Button::dead_man, 0, 0.1}, {Button::dead_man, 0.2, 0.1}, {Button::clutch, 0.1, 0.1}};
  auto scripted = hand<FalconGeometry>(config);
  for (const double t : {0.05, 0.15, 0.25, 0.35}) {
    const HandleReading reading = idle(scripted, t - 0.05, t);
    EXPECT_EQ(reading.dead_man, t == 0.05 || t == 0.25) << t;
    EXPECT_EQ(reading.clutch, t == 0.15) << t;
  }
  EXPECT_FALSE(hand<FalconGeometry>({.presses = {}}).read(kStart).dead_man);
}

TEST(SimHand, WhatCannotBeSimulatedIsRefusedInASentence) {
  EXPECT_NE(refusal([] {
              hand<FalconGeometry>({.start_p_MH = Vec3(0, 0, 0.4)});
            }).find("start_position_m"),
            std::string::npos);
  SimHandConfig stiff = quiet();
  stiff.user->impedance.twist_stiffness = 50;
  stiff.device.twist_inertia = 1e-5;
  stiff.rate = 1000;
  EXPECT_NE(refusal([&] { hand<TwinDeltaGeometry>(stiff); }).find("rate_hz"), std::string::npos);
  EXPECT_EQ(refusal([&] { hand<FalconGeometry>(stiff); }), "");  // it has no twist
  SimHandConfig fast = quiet();
  fast.user->motion.sines = {{.frequency = 50, .offset = {0.1, 0, 0}}};
  EXPECT_NE(refusal([&] { hand<TwinDeltaGeometry>(fast); }), "");
}

TEST(SimHand, ReadAndWriteTakeNothingFromTheHeap) {
  SimHandConfig config{.user = OperatorConfig{}};
  config.user->motion.sines = {{.frequency = 1, .offset = {0.03, 0, 0}, .turn = {0.1, 0.1, 0.2}}};
  config.user->motion.reaches = {{.at = 0.5, .by = {0, 0.2, 0}}};  // to the edge as well
  config.pushes = {{.at = 0.1, .force = {1, 2, 3}}};
  auto device = hand<TwinDeltaGeometry>(config);
  EXPECT_EQ(allocations_in([&] { idle(device, 0, 2); }), 0u);
  EXPECT_GT(allocations_in([] { hand<TwinDeltaGeometry>(); }), 0u);  // the count does count
  EXPECT_GT(device.truth().stops, 0u);
}

}  // namespace
}  // namespace farhand
