#include "master/force_controller.hpp"

#include <gtest/gtest.h>

#include "master/compensation.hpp"
#include "tests/support/allocations.hpp"

namespace farhand {
namespace {

constexpr double kTs = 0.001;
const WrenchLimits kLimits{
    .force = 10, .torque = 1, .twist_torque = 0.15, .force_step = 0.5, .torque_step = 0.1};

ForceLoopConfig loop(double kp, double ki = 0) {
  ForceLoopConfig l;
  l.axes.fill({.gains = {.kp = kp, .ki = ki}});
  return l;
}
ForceControllerConfig open_loop() {
  return {.limits = kLimits};
}
ForceControllerConfig closed_loop(double kp, double ki = 0) {
  return {.limits = kLimits, .closed_loop = loop(kp, ki)};
}
ForceControllerConfig everything() {
  return {.limits = kLimits,
          .closed_loop = loop(2, 5),
          .device = DeviceConfig{},
          .feedforward = DeviceFeedforwardConfig{},
          .contact_damping = ContactDampingConfig{},
          .disturbance = DisturbanceObserverConfig{}};
}

// A controller whose commands are given as they are, on a handle at rest.
struct Rig {
  explicit Rig(const ForceControllerConfig& config) : controller(config, kTs) {
    handle.status = Status::ok;
  }
  const Wrench& tick(int times = 1) {
    for (int k = 0; k < times; ++k)
      F = controller.step({.F_env_G = F_env,
                           .felt = fresh,
                           .F_user_G = felt ? &F_user : nullptr,
                           .handle = &handle,
                           .F_given_G = F,
                           .engaged = engaged},
                          limits);
    return F;
  }
  ForceController controller;
  HandlePose handle;
  Wrench F_env, F_user, F;
  bool felt = true, engaged = true, fresh = true;
  LimitSet limits = kLimitNone;
};

TEST(ForceController, OpenLoopReflectsTheEnvironmentWhateverTheUserDoes) {
  Rig rig(open_loop());
  rig.F_env = {Vec3(0.3, -0.1, 0.2), Vec3(0.02, 0, 0.01)};
  rig.F_user = {Vec3(9, 9, 9), Vec3(1, 1, 1)};
  EXPECT_EQ(rig.tick().force, Vec3(-rig.F_env.force));
  EXPECT_EQ(rig.F.torque, Vec3(-rig.F_env.torque));
  EXPECT_EQ(rig.limits, kLimitNone);
  EXPECT_FALSE(rig.controller.closes());
}

TEST(ForceController, StepsOfTheEnvironmentBecomeRamps) {
  Rig rig(open_loop());
  rig.F_env.force = Vec3(-4, 0, 0);
  for (int k = 1; k <= 8; ++k) EXPECT_NEAR(rig.tick().force.x(), 0.5 * k, 1e-12);
  EXPECT_TRUE(rig.limits & kLimitSlew);
}

// A coupling must not jerk; a contact may be as sudden as it is.
TEST(ForceController, AfterAnythingCameOrWentTheForceChangesSlower) {
  ForceControllerConfig config = open_loop();
  config.switching_share = 0.25;
  Rig rig(config);
  const auto step = [&] {
    rig.tick(300);  // 0.2 s are over
    const double before = rig.F.force.x();
    return [&rig, before](int ticks) { return std::abs(rig.tick(ticks).force.x() - before); };
  };
  const auto contact = step();
  rig.F_env.force.x() = 4;
  EXPECT_NEAR(contact(1), 0.5, 1e-12);
  for (bool* there : {&rig.engaged, &rig.fresh, &rig.felt})
    for (const bool now : {false, true}) {
      const auto change = step();
      *there = now;
      rig.F_env.force.x() = -rig.F_env.force.x();
      EXPECT_NEAR(change(1), 0.125, 1e-12);
      EXPECT_NEAR(change(19), 20 * 0.125, 1e-12);
    }
  rig.tick(300);
  rig.controller.let_go();
  EXPECT_NEAR(rig.tick().force.norm(), 0.125, 1e-12);
}

TEST(ForceController, ClosedLoopHelpsTheUserOnEveryAxisByItsOwnGain) {
  ForceControllerConfig config = closed_loop(1.2);
  config.closed_loop->axes[4].gains.kp = 0.5;
  Rig rig(config);
  rig.F_user = {Vec3(1, 2, -1), Vec3(0.1, 0.2, -0.05)};
  rig.F_env = {Vec3(0, 1, 1), Vec3(0, 0, -0.01)};
  rig.tick(2000);
  EXPECT_LT((rig.F.force - Vec3(1.2, 0.2, -3.4)).norm(), 1e-12);
  EXPECT_LT((rig.F.torque - Vec3(0.12, 0.1, -0.038)).norm(), 1e-12);
}

TEST(ForceController, EveryAxisHasAFilterOfItsOwn) {
  ForceControllerConfig config = closed_loop(1);
  config.closed_loop->axes[1].cutoff_hz = 0;
  config.closed_loop->axes[2].cutoff_hz = 5;
  Rig rig(config);
  rig.tick(200);  // the share has come in
  rig.F_user.force = Vec3(0.1, 0.1, 0.1);
  rig.tick();
  for (int i = 0; i < 3; ++i) {
    const double cutoff = config.closed_loop->axes[static_cast<std::size_t>(i)].cutoff_hz;
    EXPECT_NEAR(rig.F.force[i], 0.1 * low_pass_gain(cutoff, kTs), 1e-12) << i;
  }
}

TEST(ForceController, AtEquilibriumTheEnvironmentIsReflectedWhateverTheGains) {
  Rig rig(closed_loop(5, 100));
  rig.F_env = rig.F_user = {Vec3(3, -2, 1), Vec3(0.1, 0.05, 0.02)};
  rig.tick(3000);
  EXPECT_LT((rig.F.force + rig.F_env.force).norm(), 1e-9);
  EXPECT_LT((rig.F.torque + rig.F_env.torque).norm(), 1e-9);
}

TEST(ForceController, SwitchingNeverMakesTheForceJump) {
  for (const bool by_sensor : {false, true}) {
    Rig rig(closed_loop(2));
    rig.F_user.force = Vec3(3, 0, 0);
    bool& on = by_sensor ? rig.felt : rig.engaged;
    on = false;
    EXPECT_EQ(rig.tick(10).force.x(), 0);
    double last = 0;
    for (int k = 0; k < 600; ++k) {
      on = k < 250 || (k > 300 && k < 400);  // the second time in the midst of the fade
      rig.tick();
      EXPECT_LE(std::abs(rig.F.force.x() - last), 6 * kTs / 0.1 + 1e-12) << k;
      last = rig.F.force.x();
      EXPECT_TRUE(k != 240 || std::abs(last - 6) < 1e-9) << last;
    }
    EXPECT_EQ(last, 0);
  }
}

// The limits shorten the whole wrench; every axis whose integral drives it on must stop.
TEST(ForceController, IntegralsStopWhileTheLimitsActAndComeBackAtOnce) {
  Rig rig(closed_loop(1, 50));
  rig.F_user.force = Vec3(4, 3, 0);
  rig.tick(5000);
  EXPECT_NEAR(rig.F.force.norm(), 10, 1e-9);
  EXPECT_LT((rig.F.force.normalized() - Vec3(0.8, 0.6, 0)).norm(), 1e-3);
  EXPECT_TRUE(rig.limits & kLimitSaturated);
  rig.F_user.force = Vec3(-1, 0, 0);
  rig.tick(400);  // wound up for 5 s, it would take 20 s
  EXPECT_LT(rig.F.force.x(), 0);
}

TEST(ForceController, WhatTheMotorsCouldNotGiveStopsTheIntegralToo) {
  Rig free(closed_loop(1, 10)), held(closed_loop(1, 10));
  free.F_user.force = held.F_user.force = Vec3(0.5, 0, 0);
  for (int k = 0; k < 1000; ++k) {
    free.tick();
    held.tick();
    held.F.force *= 0.5;  // what came of the command
  }
  EXPECT_GT(free.F.force.x(), 5);
  EXPECT_LT(held.F.force.x(), 0.6);
}

TEST(ForceController, NothingNotFiniteComesOut) {
  Rig rig(everything());
  rig.F_env.force = Vec3(1, 0, 0), rig.F_user.force = Vec3(1, 1, 0);
  rig.tick(500);
  constexpr double kInfinite = std::numeric_limits<double>::infinity();
  for (const double bad : {kInfinite - kInfinite, kInfinite, -kInfinite, 1e308}) {
    for (Wrench* input : {&rig.F_env, &rig.F_user, &rig.F}) {
      const Wrench good = *input;
      input->force.y() = bad;
      for (int k = 0; k < 20; ++k) {
        rig.tick();
        ASSERT_TRUE(is_finite(rig.F)) << bad;
        ASSERT_LE(rig.F.force.norm(), 10 + 1e-9);
        input->force.y() = bad;
      }
      *input = good;
    }
    rig.tick(3000);
    EXPECT_TRUE(is_finite(rig.F));
  }
}

TEST(ForceController, AStepTakesNothingFromTheHeap) {
  Rig rig(everything());
  EXPECT_EQ(allocations_in([&] { rig.tick(100); }), 0u);
}

TEST(Compensation, HoldsThenFadesLinearlyToNothing) {
  using std::chrono::milliseconds;
  const CompensationConfig c{.hold = milliseconds(20), .fade = milliseconds(80)};
  EXPECT_EQ(fade(c, Duration(0)), 1);
  EXPECT_EQ(fade(c, milliseconds(20)), 1);
  EXPECT_NEAR(fade(c, milliseconds(40)), 0.75, 1e-15);
  EXPECT_EQ(fade(c, milliseconds(100)), 0);
  EXPECT_EQ(fade(c, Duration::max()), 0);
}

}  // namespace
}  // namespace farhand
