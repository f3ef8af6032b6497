#include "master/hand_plant.hpp"

#include <gtest/gtest.h>

#include <cmath>

namespace farhand {
namespace {

constexpr double kStep = 2e-4;

Plant frictionless() {
  Plant plant{.device = {}, .hand = kNobody};
  plant.device.damping = plant.device.friction = plant.device.weight = 0;
  plant.device.rotation_damping = plant.device.rotation_friction = plant.device.twist_damping = 0;
  return plant;
}

HandLoad run(const Plant& plant, HandState& state, double duration, const HandCourse& wish = {},
             const HandLoad& motors = {}, const Vec3& push = Vec3::Zero()) {
  HandLoad user;
  for (long i = 0; i < std::lround(duration / kStep); ++i)
    user = step(plant, state, wish, motors, push, kStep);
  return user;
}

TEST(HandPlant, TheHandsSpringHoldsAConstantForceByItsStaticDeflection) {
  Plant plant{.device = {}, .hand = {}};
  HandState state;
  const HandLoad motors{.force = {3, -1, 0}};
  const HandLoad user = run(plant, state, 20, {}, motors);
  EXPECT_LT((state.p_MH - Vec3(3, -1, -2) / 500).norm(), 1e-9);
  EXPECT_LT((user.force + Vec3(3, -1, -2)).norm(), 1e-6);
}

TEST(HandPlant, WithoutHandItSinksAtTheSpeedItsDampingAllows) {
  Plant plant{.device = {.friction = 0}, .hand = kNobody};
  HandState state;
  const HandLoad user = run(plant, state, 10);
  EXPECT_NEAR(state.v_MH.z(), -2.0 / 4, 1e-9);
  EXPECT_EQ(user.force, Vec3::Zero());
}

TEST(HandPlant, AFreeFallIsThatOfNewton) {
  Plant plant = frictionless();
  plant.device.weight = 9.81 * plant.device.mass;
  HandState state;
  run(plant, state, 1);
  EXPECT_NEAR(state.v_MH.z(), -9.81, 1e-9);
  EXPECT_NEAR(state.p_MH.z(), -9.81 / 2, 9.81 * kStep);
}

TEST(HandPlant, TiltAndTwistSpringsDeflectStatically) {
  Plant plant{.device = {}, .hand = {}};
  HandState state;
  const HandLoad motors{.moment = {0.3, 0, 0}, .twist = 0.05};
  const HandLoad user = run(plant, state, 20, {}, motors);
  EXPECT_NEAR(std::atan2(-state.axis_M.y(), state.axis_M.z()), std::asin(0.3 / 4), 1e-6);
  EXPECT_NEAR(state.twist, 0.05 / 0.5, 1e-6);
  EXPECT_NEAR(user.moment.x(), -0.3, 1e-6);
  EXPECT_NEAR(user.twist, -0.05, 1e-6);
}

TEST(HandPlant, TheAxisFollowsAConstantTurnAtItsRate) {
  Plant plant = frictionless();
  HandState state;
  state.omega_M = {0, 0.8, 0};
  run(plant, state, 1);
  EXPECT_NEAR(std::atan2(state.axis_M.x(), state.axis_M.z()), 0.8, 1e-6);
  EXPECT_NEAR(state.axis_M.norm(), 1, 1e-15);
  EXPECT_NEAR(state.omega_M.dot(state.axis_M), 0, 1e-15);
  EXPECT_NEAR(state.omega_M.norm(), 0.8, 1e-9);
}

TEST(HandPlant, EnergyNeverGrowsWhileNobodyPushes) {
  for (const bool friction : {false, true}) {
    Plant plant{.device = {}, .hand = kNobody};
    if (!friction) plant.device.friction = plant.device.rotation_friction = 0;
    HandState state;
    state.v_MH = {0.4, -0.2, 0.9};
    state.omega_M = {2, -1, 0};
    state.twist_rate = 5;
    double before = energy(plant, state);
    for (int i = 0; i < 50000; ++i) {
      step(plant, state, {}, {}, Vec3::Zero(), kStep);
      const double now = energy(plant, state);
      ASSERT_LE(now, before + 1e-15) << "friction " << friction << " step " << i;
      before = now;
    }
  }
}

TEST(HandPlant, BelowItsFrictionTheHandleOnlyCreeps) {
  Plant plant{.device = {}, .hand = kNobody};
  plant.device.weight = 0;
  HandState state;
  const double pull = 0.4;  // half the friction
  run(plant, state, 5, {}, {.force = {pull, 0, 0}});
  const double creep = 0.005 * std::atanh(0.5 * (1 - 4 * state.v_MH.x() / pull));
  EXPECT_NEAR(state.v_MH.x(), creep, 1e-9);
  EXPECT_LT(state.v_MH.x(), 0.003);
  run(plant, state, 5);
  EXPECT_LT(state.v_MH.norm(), 1e-12);
}

TEST(HandPlant, FrictionNeverTurnsAMotionRoundHoweverStiffItIs) {
  Plant plant = frictionless();
  plant.device.mass = 0.01;
  plant.device.friction = 20;
  plant.device.rotation_inertia = 1e-4;
  plant.device.rotation_friction = 2;
  HandState state;
  state.v_MH = {0.5, 0, 0};
  state.omega_M = {0, 10, 0};
  for (int i = 0; i < 1000; ++i) {
    const HandState before = state;
    step(plant, state, {}, {}, Vec3::Zero(), 1e-3);
    ASSERT_GE(state.v_MH.x(), 0);
    ASSERT_LE(state.v_MH.x(), before.v_MH.x());
    ASSERT_GE(state.omega_M.y(), 0);
    ASSERT_LE(state.omega_M.norm(), before.omega_M.norm());
  }
  EXPECT_LT(state.v_MH.norm(), 1e-9);
}

TEST(HandPlant, TheSensorReadsTheDeviceSideOfNewtonsLaw) {
  Plant plant{.device = {}, .hand = {}};
  HandState state, before;
  const HandLoad motors{.force = {1, 2, -1}};
  const Vec3 push(0.3, -0.7, 1);
  for (int i = 1; i < 2000; ++i) {
    const double t = i * kStep;
    HandCourse wish;
    wish.p = {Vec3(0.02 * std::sin(9 * t), 0, 0), Vec3(0.18 * std::cos(9 * t), 0, 0)};
    before = state;
    const HandLoad user = step(plant, state, wish, motors, push, kStep);
    const double speed = before.v_MH.norm();
    const double brake = 4 + (speed > 1e-12 ? 0.8 * std::tanh(speed / 0.005) / speed : 0.8 / 0.005);
    const Vec3 inertia = plant.device.mass * (state.v_MH - before.v_MH) / kStep;
    ASSERT_LT(
        (inertia - (user.force + motors.force - 2 * Vec3::UnitZ() - brake * state.v_MH)).norm(),
        1e-10);
  }
}

TEST(HandPlant, APointDoesNotTurn) {
  Plant plant{.device = {}, .hand = {}, .rotates = false};
  HandState state;
  const HandLoad user =
      run(plant, state, 1, {}, {.force = {1, 0, 0}, .moment = {1, 0, 0}, .twist = 1});
  EXPECT_EQ(state.axis_M, Vec3::UnitZ());
  EXPECT_EQ(state.twist, 0);
  EXPECT_EQ(user.moment, Vec3::Zero());
  EXPECT_GT(state.p_MH.x(), 1e-3);
}

}  // namespace
}  // namespace farhand
