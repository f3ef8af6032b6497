#include "master/master.hpp"

#include <gtest/gtest.h>

#include "tests/support/master_rig.hpp"

namespace farhand {
namespace {

using std::chrono::milliseconds;
using Rig = MasterRig;

// What the motors do to the hand, from their torques.
Wrench felt(const MasterTick& t, const HandleReading& reading) {
  const TwinDeltaForward at = forward(kTwinDelta, reading.theta);
  return wrench(jacobian(kTwinDelta, at, t.handle.R_MG), t.tau);
}

TEST(Master, SendsTheHandlesPose) {
  Rig rig;
  rig.tick();
  EXPECT_NEAR((rig.sent.p_MH - Vec3(0.18, 0, 0)).norm(), 0, 1e-14);
  EXPECT_NEAR(rig.sent.q_MH.angularDistance(Quat::Identity()), 0, 1e-12);
  EXPECT_EQ(rig.sent.V_MH.linear, Vec3::Zero());
}

TEST(Master, ReflectsTheContactForceThroughTheMotorsOnceEngaged) {
  Rig rig;
  rig.answer.F_E_M = {Vec3(-3, 2, 1), Vec3(0.05, -0.02, 0.01)};
  rig.answer.mode = Mode::ready;
  EXPECT_EQ(rig.tick(20).tau, Vec6::Zero());
  rig.engage();
  const MasterTick& t = rig.tick(100);
  EXPECT_EQ(t.mode, Mode::engaged);
  EXPECT_NEAR((felt(t, rig.reading).force + rig.answer.F_E_M.force).norm(), 0, 1e-12);
  EXPECT_NEAR((felt(t, rig.reading).torque + rig.answer.F_E_M.torque).norm(), 0, 1e-12);
}

TEST(Master, TheForceOnTheHandNeverJumps) {
  Rig rig;
  rig.engage();
  Wrench last = rig.tick().F_G;
  const auto check = [&](int ticks) {
    for (int k = 0; k < ticks; ++k) {
      const MasterTick& t = rig.tick();
      EXPECT_LE((t.F_G.force - last.force).norm(), 0.5 + 1e-12);
      last = t.F_G;
    }
  };
  rig.answer.F_E_M.force = Vec3(15, 0, 0);
  check(60);
  rig.answer.F_E_M.force = Vec3(-15, 0, 0);
  check(100);
  rig.reading.dead_man = false;
  check(60);
  EXPECT_EQ(rig.tick().tau, Vec6::Zero());
}

TEST(Master, AnOldWrenchIsHeldThenFadesAndTheEngagementEnds) {
  MasterConfig config = Rig::default_config();
  config.stale = milliseconds(500);
  Rig rig(config);
  rig.answer.F_E_M.force = Vec3(4, 0, 0);
  rig.engage();
  rig.tick(50);
  rig.age = milliseconds(20);
  EXPECT_NEAR(rig.tick(20).F_env_G.force.x(), 4, 1e-12);
  rig.age = milliseconds(60);
  EXPECT_NEAR(rig.tick(20).F_env_G.force.x(), 2, 1e-12);
  EXPECT_TRUE(rig.tick().limits & kLimitStale);
  rig.age = milliseconds(100);
  EXPECT_EQ(rig.tick(20).F_env_G.force.x(), 0);
  rig.age = milliseconds(501);
  EXPECT_EQ(rig.tick().mode, Mode::holding);
  rig.age = {};
  EXPECT_EQ(rig.tick(50).mode, Mode::holding);
  EXPECT_EQ(rig.tick().tau, Vec6::Zero());
}

TEST(Master, ASlaveThatStopsEndsTheEngagementUntilANewPress) {
  Rig rig;
  rig.engage();
  rig.answer.mode = Mode::holding;
  EXPECT_EQ(rig.tick().mode, Mode::holding);
  rig.answer.mode = Mode::ready;
  EXPECT_EQ(rig.tick(10).mode, Mode::holding);
  rig.reading.dead_man = false;
  EXPECT_EQ(rig.tick().mode, Mode::ready);
  rig.reading.dead_man = true;
  EXPECT_EQ(rig.tick().mode, Mode::engaged);
}

MasterConfig aligning() {
  MasterConfig config = Rig::default_config();
  config.alignment = 0.1;
  return config;
}

// The slave tells that the robot stands as the handle would if it were turned by this.
void robot_turned(Rig& rig, double x) {
  rig.answer.has_robot = true;
  rig.answer.q_MR = to_quat(rotation(Vec3(x, 0, 0)));
}

TEST(Master, EngagesOnlyAHandleThatIsTurnedAsTheRobot) {
  Rig rig(aligning());
  rig.answer.mode = Mode::ready;
  EXPECT_EQ(rig.tick().mode, Mode::ready);  // no coupling yet
  robot_turned(rig, 0.4);
  const MasterTick& t = rig.tick();
  EXPECT_EQ(t.mode, Mode::aligning);
  EXPECT_EQ(rig.sent.reason, Reason::turn_handle);
  EXPECT_LT((t.turn_M - Vec3(0.4, 0, 0)).norm(), 1e-12);
  rig.reading.dead_man = true;
  EXPECT_EQ(rig.tick(20).reason, Reason::turn_handle);
  robot_turned(rig, 0.09);
  EXPECT_EQ(rig.tick(20).reason, Reason::dead_man_held);
  rig.reading.dead_man = false;
  EXPECT_EQ(rig.tick().mode, Mode::ready);
  rig.reading.dead_man = true;
  EXPECT_EQ(rig.tick().mode, Mode::engaged);
}

TEST(Master, ASlaveThatWaitsForTheHandleIsBelieved) {
  Rig rig(aligning());
  rig.answer.mode = Mode::aligning;
  rig.answer.reason = Reason::turn_handle;
  robot_turned(rig, 0.05);
  EXPECT_EQ(rig.tick().reason, Reason::turn_handle);
  rig.answer.reason = Reason::silent;
  EXPECT_EQ(rig.tick().reason, Reason::partner_not_ready);
}

// On a long way the answers do not know yet that the robot is coupled, or that it is no more.
TEST(Master, OnceEngagedTheHandleIsJudgedWhenTheClutchIsLetGo) {
  Rig rig(aligning());
  rig.engage();
  const auto uncoupled = [&](double x) -> const MasterTick& {
    robot_turned(rig, x);
    rig.answer.coupled = false;
    return rig.tick();
  };
  EXPECT_EQ(uncoupled(0.5).mode, Mode::engaged);
  rig.reading.clutch = true;
  EXPECT_EQ(uncoupled(0.5).mode, Mode::engaged);
  EXPECT_FALSE(uncoupled(0.5).aligned);
  rig.reading.clutch = false;
  EXPECT_EQ(uncoupled(0.09).mode, Mode::engaged);
  rig.reading.clutch = true;
  EXPECT_EQ(uncoupled(0.5).mode, Mode::engaged);
  rig.reading.clutch = false;
  EXPECT_EQ(uncoupled(0.5).mode, Mode::aligning);
}

TEST(Master, AnAnswerFromBeforeAPressOfTheClutchIsNotJudgedBy) {
  Rig rig(aligning());
  rig.engage();
  rig.hears = false;
  robot_turned(rig, 0.5);  // as when the handle was coupled before
  for (const bool clutch : {true, false}) {
    rig.reading.clutch = clutch;
    rig.answer.coupled = false;
    EXPECT_EQ(rig.tick().mode, Mode::engaged);
  }
  rig.answer.reason = Reason::turn_handle;  // the slave, by what it knows
  rig.answer.mode = Mode::aligning;
  rig.answer.coupled = false;
  EXPECT_EQ(rig.tick().mode, Mode::aligning);
  rig.reading.dead_man = false;
  rig.answer.reason = Reason::none;
  rig.answer.mode = Mode::ready;
  EXPECT_EQ(rig.tick().mode, Mode::ready);
  rig.hears = true;
  EXPECT_EQ(rig.tick(2).reason, Reason::turn_handle);
}

TEST(Master, ARobotToldWithoutBeingCoupledIsNotFelt) {
  MasterConfig config = aligning();
  config.robot_coupling.emplace();
  Rig rig(config);
  rig.engage();
  robot_turned(rig, 0.05);
  rig.answer.coupled = false;
  EXPECT_EQ(rig.tick().F_env_G.torque, Vec3::Zero());
  EXPECT_GT(rig.tick().F_env_G.torque.norm(), 0.05);  // coupled again
}

TEST(Master, StoppedLetsEveryForceGoAndIsFinal) {
  Rig rig;
  rig.answer.F_E_M.force = Vec3(4, 0, 0);
  rig.engage();
  rig.tick(50);
  rig.master.stop();
  EXPECT_EQ(rig.tick().mode, Mode::stopped);
  EXPECT_EQ(rig.tick(50).tau, Vec6::Zero());
  rig.reading.dead_man = false;
  EXPECT_EQ(rig.tick(10).mode, Mode::stopped);
}

TEST(Master, WithoutForceFeedbackTheMotorsStayAtZero) {
  MasterConfig config = Rig::default_config();
  config.force_feedback.reset();
  Rig rig(config);
  rig.answer.F_E_M.force = Vec3(4, 0, 0);
  rig.engage();
  EXPECT_EQ(rig.tick(50).tau, Vec6::Zero());
  EXPECT_FALSE(rig.sent.force_wanted);
}

TEST(Master, ClutchFreesTheHandOfForce) {
  Rig rig;
  rig.answer.F_E_M.force = Vec3(4, 0, 0);
  rig.engage();
  EXPECT_GT(rig.tick(50).F_G.force.norm(), 3.9);
  rig.reading.clutch = true;
  for (int k = 0; k < 50; ++k) {
    rig.tick();
    rig.answer.coupled = false;  // what the slave answers to the clutch
    rig.tick();
    rig.answer.coupled = false;
  }
  EXPECT_LT(rig.master.actuate(rig.now, {&rig.answer, true, {}, true}).F_G.force.norm(), 0.6);
}

TEST(Master, CountsPresses) {
  Rig rig;
  for (int k = 0; k < 3; ++k) {
    rig.reading.dead_man = rig.reading.clutch = true;
    rig.tick(2);
    rig.reading.dead_man = rig.reading.clutch = false;
    rig.tick(2);
  }
  EXPECT_EQ(rig.sent.dead_man_presses, 3u);
  EXPECT_EQ(rig.sent.clutch_presses, 3u);
}

TEST(Master, FalconReflectsForceInItsOwnAxes) {
  MasterConfig config = Rig::default_config();
  config.handle = FalconHandle{};
  Rig rig(config);
  const Vec3 p(0.01, 0.005, 0.12);
  rig.reading.theta.setZero();
  rig.reading.theta.head<3>() = motor_angles(kFalconTable1, p).theta1;
  rig.answer.F_E_M.force = Vec3(1, -2, 3);
  rig.engage();
  const MasterTick& t = rig.tick(100);
  const Vec3 f = force(jacobian(kFalconTable1, p), t.tau.head<3>());
  EXPECT_NEAR((f + rig.answer.F_E_M.force).norm(), 0, 1e-12);
  EXPECT_EQ(t.tau.tail<3>(), Vec3::Zero());
}

// A Falcon held by position control, its slave pressing with F_E_M.
MasterConfig cued(double contact) {
  MasterConfig config;
  config.handle = FalconHandle{};
  config.stale = milliseconds(500);
  config.position_control.emplace();
  config.position_control->danger_cue = DangerCueConfig{.contact = contact};
  return config;
}

TEST(Master, TheCueTakesWhatTheRobotPressesOnForADanger) {
  Rig rig(cued(10));
  const Vec3 p(0, 0, 0.12);
  rig.reading.theta.setZero();
  rig.reading.theta.head<3>() = motor_angles(kFalconTable1, p).theta1;
  const auto shift = [&] { return Vec3(rig.tick(300).p_MH_target - p); };
  EXPECT_LE(shift().norm(), 1e-12);
  EXPECT_TRUE(rig.sent.force_wanted);
  rig.answer.F_E_M.force = Vec3(0, 3, -4);
  EXPECT_LE((shift() - 0.01 * Vec3(0, -0.6, 0.8)).norm(), 1e-12);
  rig.answer.F_E_M.force *= 10;
  EXPECT_LE((shift() - 0.02 * Vec3(0, -0.6, 0.8)).norm(), 1e-12);
  rig.age = milliseconds(60);  // half faded
  EXPECT_LE((shift() - 0.01 * Vec3(0, -0.6, 0.8)).norm(), 1e-12);
  rig.age = milliseconds(501);
  EXPECT_LE(shift().norm(), 1e-12);
  rig.age = {};
  EXPECT_GT(shift().norm(), 0.019);
  rig.connected = false;
  EXPECT_LE(shift().norm(), 1e-12);
}

TEST(Master, ACueWithoutContactAsksForNoForceAndHeedsNone) {
  Rig rig(cued(0));
  const Vec3 p(0, 0, 0.12);
  rig.reading.theta.setZero();
  rig.reading.theta.head<3>() = motor_angles(kFalconTable1, p).theta1;
  rig.answer.F_E_M.force = Vec3(0, 3, -4);
  EXPECT_LE((rig.tick(300).p_MH_target - p).norm(), 1e-12);
  EXPECT_FALSE(rig.sent.force_wanted);
}

}  // namespace
}  // namespace farhand
