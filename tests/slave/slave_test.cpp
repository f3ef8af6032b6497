#include "slave/slave.hpp"

#include <gtest/gtest.h>

#include <limits>

#include "slave/sim_arm.hpp"

namespace farhand {
namespace {

using std::chrono::milliseconds;

// A robot that is where it was told to be, and a master whose message is always the one set here.
struct Rig {
  explicit Rig(SlaveConfig config = default_config()) : slave(config) { robot.q = kTeleopHome; }

  static SlaveConfig default_config() {
    SlaveConfig c;
    c.workspace.R_SM = twin_delta_axes();
    c.servo.gravity_compensation = true;
    return c;
  }

  const SlaveTick& tick(int times = 1) {
    const SlaveTick* t = nullptr;
    for (int i = 0; i < times; ++i) {
      now += milliseconds(1);
      t = &slave.tick(now, {.newest = &message, .connected = connected, .age = age, .synced = true},
                      robot);
      robot.q = t->q_cmd;
    }
    return *t;
  }
  void press() {
    message.dead_man = true;
    message.mode = Mode::engaged;
  }
  void release() {
    message.dead_man = false;
    message.mode = Mode::ready;
  }
  void engage() {
    release();
    tick(2);
    press();
    tick();
  }

  Slave slave;
  RobotReading robot{.ok = true};
  MasterToSlave message{.p_MH = Vec3(0.18, 0, 0)};
  bool connected = true;
  Duration age{};
  TimePoint now{};
};

TEST(Slave, FollowsTheHandleOnlyWhileTheDeadManIsHeld) {
  Rig rig;
  const Vec3 home = rig.tick().X_SE.p;
  rig.message.p_MH.x() -= 0.01;
  EXPECT_EQ(rig.tick(50).mode, Mode::ready);
  EXPECT_EQ(rig.robot.q, kTeleopHome);
  rig.engage();
  rig.message.p_MH.x() -= 0.02;  // forward
  const SlaveTick& t = rig.tick(100);
  EXPECT_EQ(t.mode, Mode::engaged);
  EXPECT_NEAR((t.X_SE.p - (home + Vec3(0, 0.02, 0))).norm(), 0, 1e-12);
  rig.release();
  rig.message.p_MH.x() -= 0.02;
  const Vec6 q = rig.tick().q_cmd;
  EXPECT_EQ(rig.tick(100).q_cmd, q);
}

TEST(Slave, AVirtualMassWaitsAtTheEndOfTheReachAndComesBackAtOnce) {
  SlaveConfig config = Rig::default_config();
  config.admittance = AdmittanceConfig{.mass = 1, .damping = 10};
  config.sends_robot = true;
  Rig rig(config);
  rig.engage();
  rig.message.has_user_wrench = true;
  rig.message.F_user_M.force = {-5, 0, 0};  // forward: half a metre per second
  const SlaveTick& t = rig.tick(5000);
  EXPECT_NE(t.limits & kLimitWorkspace, 0u);
  EXPECT_LT((t.X_SE_target.p - t.X_SE.p).norm(), 1e-3);
  EXPECT_GT(t.X_SE.p.y(), 0.5);
  EXPECT_LT(t.out.p_MR.x(), 0);  // the same way, told in the handle's terms
  const double there = t.X_SE.p.y();
  rig.message.F_user_M.force = {5, 0, 0};
  EXPECT_LT(rig.tick(100).X_SE.p.y(), there - 0.01);
}

TEST(Slave, TheUsersForcePushesTheArmBesideItsServo) {
  SlaveConfig config = Rig::default_config();
  Rig without(config);
  config.user_force = UserForceConfig{};
  Rig with(config);
  for (Rig* rig : {&without, &with}) {
    rig->engage();
    rig->message.has_user_wrench = true;
    rig->message.F_user_M.force = {-6, 0, 0};
  }
  const Vec6 more = with.tick(50).tau - without.tick(50).tau;
  const ArmKinematics at = kinematics(config.arm, kTeleopHome);
  const Vec6 pushed = joint_torques(at.J, {.force = {0, 6, 0}});
  EXPECT_LT((more - pushed).cwiseAbs().maxCoeff(), 1e-12);
}

TEST(Slave, AReadingThatCannotBeIsNoReading) {
  for (const double value : {std::numeric_limits<double>::quiet_NaN(), 1e300}) {
    Rig rig;
    rig.engage();
    const Vec6 tau = rig.tick(50).tau;
    rig.robot.dq[2] = value;
    const SlaveTick& t = rig.tick();
    EXPECT_EQ(t.mode, Mode::holding) << value;
    EXPECT_EQ(t.reason, Reason::implausible) << value;
    EXPECT_EQ(t.tau, tau) << value;
    EXPECT_TRUE(t.out.V_SE.linear.allFinite()) << value;
  }
}

TEST(Slave, AJointThatLeapsIsNoReadingAndLeavesTheCommandAlone) {
  Rig rig;
  rig.engage();
  const SlaveTick before = rig.tick(50);
  rig.robot.q[1] = 0;
  EXPECT_EQ(rig.tick().reason, Reason::implausible);
  EXPECT_EQ(rig.tick().reason, Reason::implausible);  // back again is a leap, too
  const SlaveTick& t = rig.tick();
  EXPECT_EQ(t.mode, Mode::holding);
  EXPECT_TRUE(t.robot.ok);
  EXPECT_EQ(t.q_cmd, before.q_cmd);
}

// An encoder that slipped, or an arm that was moved while nobody read it.
TEST(Slave, WhereALeapStaysTheRobotIsHeldAndNotDrivenBack) {
  Rig rig;
  rig.engage();
  rig.tick(50);
  Vec6 there = kTeleopHome;
  there[1] += 0.5;
  rig.robot.q = there;
  EXPECT_FALSE(rig.tick().robot.ok);
  rig.robot.q = there;
  EXPECT_TRUE(rig.tick().robot.ok);
  EXPECT_EQ(rig.tick(20).q_cmd, there);
}

TEST(Slave, ClutchPressesOfAMasterNotHeardYetClearNoFault) {
  Rig rig;
  rig.tick(10);
  rig.robot.ok = false;
  ASSERT_EQ(rig.tick(60).mode, Mode::fault);
  rig.robot.ok = true;
  rig.slave.tick(rig.now += milliseconds(1), {}, rig.robot);  // nobody
  rig.message.clutch_presses = 7;  // another master, pressed while it waited
  EXPECT_EQ(rig.tick(5).mode, Mode::fault);
  rig.message.clutch_presses = 8;
  EXPECT_NE(rig.tick(5).mode, Mode::fault);
}

// One wrong reading is not where the arm is to be driven.
TEST(Slave, AWrongReadingDoesNotSayWhereTheRobotIsFound) {
  const auto at = [](Rig& rig, const Vec6& q) -> const SlaveTick& {
    rig.robot.q = q;
    return rig.tick();
  };
  Vec6 wrong = kTeleopHome;
  wrong[1] = 0;

  Rig starting;
  EXPECT_EQ(at(starting, wrong).q_cmd, wrong);
  EXPECT_FALSE(at(starting, kTeleopHome).robot.ok);
  EXPECT_EQ(at(starting, kTeleopHome).q_cmd, kTeleopHome);

  Rig failing;
  failing.engage();
  failing.robot.ok = false;
  EXPECT_EQ(failing.tick(60).mode, Mode::fault);
  failing.robot.ok = true;
  EXPECT_FALSE(at(failing, wrong).robot.ok);
  EXPECT_FALSE(at(failing, kTeleopHome).robot.ok);
  EXPECT_EQ(at(failing, kTeleopHome).q_cmd, kTeleopHome);
}

TEST(Slave, ClutchHoldsTheToolAndReleasingItDoesNotMakeItJump) {
  Rig rig;
  rig.engage();
  rig.message.p_MH.z() += 0.01;
  const Vec6 q = rig.tick(50).q_cmd;
  rig.message.clutch = true;
  rig.message.p_MH.z() -= 0.03;
  rig.message.q_MH = Quat(Eigen::AngleAxisd(0.4, Vec3::UnitX()));
  EXPECT_EQ(rig.tick(50).q_cmd, q);
  EXPECT_FALSE(rig.tick().coupled);
  rig.message.clutch = false;
  EXPECT_NEAR((rig.tick().q_cmd - q).norm(), 0, 1e-13);
  EXPECT_TRUE(rig.tick().coupled);
}

Quat turned(double x, double y = 0, double z = 0) {
  return to_quat(rotation(Vec3(x, y, z)));
}

SlaveConfig aligning() {
  SlaveConfig config = Rig::default_config();
  config.workspace.alignment = 0.1;
  return config;
}

TEST(Slave, ALaterCouplingWaitsUntilTheHandleIsTurnedBack) {
  Rig rig(aligning());
  rig.message.q_MH = turned(0, 0, 0.3);
  rig.engage();
  EXPECT_TRUE(rig.tick().coupled);
  EXPECT_FALSE(rig.tick().out.has_robot);
  rig.message.q_MH = turned(0, 0, 0.5);
  rig.tick(200);
  rig.release();
  EXPECT_EQ(rig.tick().mode, Mode::ready);
  EXPECT_TRUE(rig.tick().out.has_robot);
  EXPECT_LT(rig.tick().out.q_MR.angularDistance(rig.message.q_MH), 1e-12);
  rig.message.q_MH = turned(0.4) * turned(0, 0, 0.5);
  const SlaveTick off = rig.tick();
  EXPECT_EQ(off.mode, Mode::aligning);
  EXPECT_EQ(off.out.reason, Reason::turn_handle);
  EXPECT_LT((off.turn_M - Vec3(-0.4, 0, 0)).norm(), 1e-12);
  rig.press();  // a master that does not look
  for (int k = 0; k < 50; ++k) EXPECT_FALSE(rig.tick().coupled);
  EXPECT_EQ(rig.tick().q_cmd, off.q_cmd);
  EXPECT_EQ(rig.tick().reason, Reason::turn_handle);
  rig.message.q_MH = turned(0.09) * turned(0, 0, 0.5);
  EXPECT_EQ(rig.tick().reason, Reason::dead_man_held);
  rig.release();
  EXPECT_EQ(rig.tick().mode, Mode::ready);
  rig.press();
  const SlaveTick& t = rig.tick(20);
  EXPECT_TRUE(t.coupled);
  EXPECT_LT((t.q_cmd - off.q_cmd).norm(), 1e-12);  // the rest of the angle turns nothing
  EXPECT_NEAR(t.turn_M.norm(), 0.09, 1e-12);
}

// Turned one way before every coupling, the handle is soon too far from the first one.
TEST(Slave, WhatIsLeftOfTheAngleDoesNotAddUpOverManyCouplings) {
  Rig rig(aligning());
  rig.engage();
  double angle = 0;
  for (int k = 1; k <= 5; ++k) {
    rig.release();
    rig.tick(2);
    rig.message.q_MH = turned(0, angle += 0.045);
    rig.tick(2);
    rig.press();
    EXPECT_EQ(rig.tick(2).coupled, k <= 2) << k;
  }
}

TEST(Slave, UnderTheClutchTheHandleMayBeTurnedAwayAndBack) {
  Rig rig(aligning());
  rig.engage();
  rig.message.clutch = true;
  rig.message.q_MH = turned(0, 0.5);
  EXPECT_EQ(rig.tick(5).mode, Mode::engaged);
  EXPECT_FALSE(rig.tick().aligned);
  rig.message.q_MH = turned(0, 0.05);
  rig.tick();
  rig.message.clutch = false;
  EXPECT_TRUE(rig.tick().coupled);
  rig.message.clutch = true;
  rig.message.q_MH = turned(0, 0.5);
  rig.tick();
  rig.message.clutch = false;
  EXPECT_EQ(rig.tick().mode, Mode::aligning);
  EXPECT_FALSE(rig.tick().coupled);
}

TEST(Slave, AMasterThatIsStartedAgainMustTurnTheHandleAndARobotFoundElsewhereNeedNot) {
  Rig rig(aligning());
  rig.engage();
  rig.connected = false;
  rig.tick(10);
  rig.connected = true;
  rig.message = {.p_MH = Vec3(0.18, 0, 0), .q_MH = turned(0.5)};
  rig.engage();
  EXPECT_FALSE(rig.tick().coupled);
  rig.robot.ok = false;
  EXPECT_EQ(rig.tick(60).mode, Mode::fault);
  rig.robot.ok = true;
  rig.robot.q = kTeleopHome + Vec6::Constant(0.1);
  rig.tick();
  EXPECT_FALSE(rig.tick().out.has_robot);
  rig.release();
  ++rig.message.clutch_presses;
  EXPECT_EQ(rig.tick().mode, Mode::ready);
  rig.press();
  EXPECT_TRUE(rig.tick().coupled);
}

// Uncoupled, its handle turned away, and the master says so.
void wait_for_turn(Rig& rig) {
  rig.engage();
  rig.release();
  rig.message.q_MH = turned(0.5);
  rig.tick();
  rig.message.mode = Mode::aligning;
  rig.message.reason = Reason::turn_handle;
  EXPECT_EQ(rig.tick().reason, Reason::turn_handle);
}

TEST(Slave, APressOfTheClutchTakesTheHandleAsItIs) {
  Rig rig(aligning());
  wait_for_turn(rig);
  const Vec6 q = rig.tick().q_cmd;
  ++rig.message.clutch_presses;
  rig.message.clutch = true;
  EXPECT_FALSE(rig.tick().out.has_robot);
  EXPECT_EQ(rig.tick().mode, Mode::ready);
  rig.message.clutch = false;
  rig.message.reason = Reason::none;
  rig.engage();
  EXPECT_TRUE(rig.tick().coupled);
  EXPECT_LT((rig.tick(20).q_cmd - q).norm(), 1e-12);
  rig.release();
  EXPECT_EQ(rig.tick(2).mode, Mode::ready);  // this orientation is the tool's now
  rig.message.q_MH = turned(0);
  EXPECT_EQ(rig.tick().reason, Reason::turn_handle);
}

TEST(Slave, APressMeantForSomethingElseDoesNotTakeTheHandle) {
  const auto still_waits = [](Rig& rig) {
    ++rig.message.clutch_presses;
    EXPECT_TRUE(rig.tick().out.has_robot);
    EXPECT_EQ(rig.tick(5).reason, Reason::turn_handle);
  };
  Rig held(aligning());
  wait_for_turn(held);
  held.message.dead_man = true;
  still_waits(held);
  held.message.dead_man = false;  // pressed under the dead-man, which was let go in a lost message
  still_waits(held);

  Rig unaware(aligning());  // of a master that did not say so yet
  wait_for_turn(unaware);
  unaware.message.reason = Reason::none;
  still_waits(unaware);
  unaware.message.reason = Reason::turn_handle;  // pressed before, in a lost message
  still_waits(unaware);

  Rig early(aligning());  // with the first turned away
  wait_for_turn(early);
  early.message.q_MH = turned(0);
  EXPECT_EQ(early.tick().mode, Mode::ready);
  early.message.q_MH = turned(0.5);
  still_waits(early);

  Rig another(aligning());  // of a master that was not heard before
  wait_for_turn(another);
  another.slave.tick(another.now += milliseconds(1), {}, another.robot);
  another.message.clutch_presses = 7;
  still_waits(another);
}

TEST(Slave, WithoutAlignmentAnyHandleIsCoupledAndAnUncoupledRobotNotTold) {
  SlaveConfig config = Rig::default_config();
  config.sends_robot = true;
  Rig rig(config);
  rig.engage();
  EXPECT_TRUE(rig.tick().out.has_robot);
  rig.release();
  rig.message.q_MH = turned(1);
  EXPECT_EQ(rig.tick(2).mode, Mode::ready);
  EXPECT_FALSE(rig.tick().out.has_robot);
  rig.press();
  EXPECT_TRUE(rig.tick().coupled);
}

TEST(Slave, AnOldMessageHoldsTheRobotUntilANewPress) {
  Rig rig;
  rig.engage();
  rig.message.p_MH.y() += 0.01;
  const Vec6 q = rig.tick(50).q_cmd;
  rig.age = milliseconds(21);
  EXPECT_EQ(rig.tick().mode, Mode::holding);
  EXPECT_TRUE(rig.tick().limits & kLimitStale);
  rig.age = {};
  rig.message.p_MH.y() += 0.01;
  EXPECT_EQ(rig.tick(100).mode, Mode::holding);
  EXPECT_EQ(rig.tick().q_cmd, q);
  rig.release();
  EXPECT_EQ(rig.tick().mode, Mode::ready);
  rig.press();
  EXPECT_EQ(rig.tick().mode, Mode::engaged);
}

TEST(Slave, AMasterThatIsNotEngagedItselfMovesNothing) {
  Rig rig;
  rig.engage();
  rig.message.mode = Mode::holding;  // it no longer hears us
  EXPECT_EQ(rig.tick().mode, Mode::ready);
}

TEST(Slave, ALostMasterLeavesTheRobotHeld) {
  Rig rig;
  rig.engage();
  rig.connected = false;
  EXPECT_EQ(rig.tick().mode, Mode::disconnected);
  const Vec6 q = rig.tick().q_cmd;
  EXPECT_EQ(rig.tick(100).q_cmd, q);
}

TEST(Slave, AnUnreachableTargetHoldsTheLastJointCommandAndSaysSo) {
  SlaveConfig config = Rig::default_config();
  config.workspace.scale = 2;
  Rig rig(config);
  rig.engage();
  for (int k = 0; k < 400; ++k) {
    rig.message.p_MH.x() -= 0.001;
    rig.tick();
  }
  const SlaveTick& t = rig.tick(500);
  EXPECT_EQ(t.inverse, Status::too_far);
  EXPECT_TRUE(t.limits & kLimitWorkspace);
  EXPECT_EQ(t.mode, Mode::engaged);
  EXPECT_TRUE(t.coupled);
  const Vec6 q = t.q_cmd;
  EXPECT_EQ(rig.tick(10).q_cmd, q);
  rig.message.p_MH.x() += 0.35;  // back in reach
  EXPECT_EQ(rig.tick(800).inverse, Status::ok);
}

TEST(Slave, JointSpeedsAreLimitedWhateverTheHandleDoes) {
  Rig rig;
  const Vec6 step = rig.slave.config().joints.speed * 1e-3;
  rig.engage();
  Vec6 last = rig.tick().q_cmd;
  for (int k = 0; k < 200; ++k) {
    rig.message.p_MH = Vec3(0.18 + 0.1 * ((k / 20) % 2), 0.05 * ((k / 7) % 3), 0);
    const SlaveTick& t = rig.tick();
    EXPECT_LE((t.q_cmd - last).cwiseAbs().cwiseQuotient(step).maxCoeff(), 1 + 1e-9);
    last = t.q_cmd;
  }
}

// The largest overrun of a joint limit, and how far from one the arm ends at the nearest [rad].
struct AtLimit {
  double beyond = -1, end = 1;
};

AtLimit turn_to_limit(const Vec3& axis, double rate) {
  SlaveConfig config = Rig::default_config();
  config.servo.velocity_feedforward.emplace();
  config.servo.friction_compensation.emplace();
  Rig rig(config);
  SimArm arm({.model = config.model, .q = kTeleopHome});
  AtLimit out;
  for (int k = 0; k < 6000; ++k) {
    rig.robot = arm.read(rig.now);
    if (k == 2) rig.press();
    const double turned = std::min(rate * 1e-3 * std::max(k - 2, 0), 2.5);
    rig.message.q_MH = Quat(Eigen::AngleAxisd(turned, axis));
    rig.now += milliseconds(1);
    const SlaveTick& t = rig.slave.tick(
        rig.now, {.newest = &rig.message, .connected = true, .age = {}, .synced = true}, rig.robot);
    arm.write(rig.now, t.tau);
    const Vec6 q = arm.truth().q;
    const double past = (q - config.joints.upper).cwiseMax(config.joints.lower - q).maxCoeff();
    out = {std::max(out.beyond, past), -past};
  }
  return out;
}

// Turned towards it by far more than that, at any speed up to its largest, both ways of joint 5 and
// through several joints. What is out of reach is not followed, which may be a whole step early.
TEST(Slave, AJointComesToRestAtItsLimitWithoutRunningBeyond) {
  constexpr double kBeyond = 0.002;  // 0.0018 about -y at 6 rad/s, 0.0004 otherwise
  constexpr double kRest = 0.005;
  for (const Vec3& axis : {Vec3(0, 1, 0), Vec3(0, -1, 0), Vec3(0, 0, 1)})
    for (const double rate : {0.5, 2., 6., 20.}) {
      const AtLimit at = turn_to_limit(axis, rate);
      EXPECT_LT(at.beyond, kBeyond) << axis.transpose() << " at " << rate;
      EXPECT_LT(at.end, kRest + rate * 1e-3) << axis.transpose() << " at " << rate;
    }
}

TEST(Slave, AJointCommandArrivesAtATargetOnItsLimit) {
  const auto lifted = [](Rig& rig) {
    rig.engage();
    rig.message.p_MH += Vec3(0.01, -0.02, 0.03);
    return SlaveTick(rig.tick(3000));
  };
  SlaveConfig config = Rig::default_config();
  Rig free(config);
  const Vec6 q = lifted(free).q_cmd;
  for (int i = 0; i < 6; ++i)
    (q[i] > kTeleopHome[i] ? config.joints.upper : config.joints.lower)[i] = q[i];
  Rig rig(config);
  const SlaveTick t = lifted(rig);
  EXPECT_EQ(t.inverse, Status::ok);
  EXPECT_EQ(t.q_cmd, q);
  EXPECT_EQ(t.limits & kLimitSpeed, 0u);
}

TEST(Slave, TorquesStayWithinTheirLimitsAndSlew) {
  Rig rig;
  rig.engage();
  Vec6 last = rig.tick().tau;
  for (int k = 0; k < 200; ++k) {
    rig.robot.q = kTeleopHome + Vec6::Constant(k % 2 == 0 ? 3 : -3);
    const SlaveTick& t =
        rig.slave.tick(rig.now += milliseconds(1), {&rig.message, true, {}, true}, rig.robot);
    for (int i = 0; i < 6; ++i) {
      const double max = rig.slave.config().model.links[i].torque_limit;
      EXPECT_LE(std::abs(t.tau[i]), max);
      EXPECT_LE(std::abs(t.tau[i] - last[i]), max * 0.05 * (1 + 1e-9));
    }
    last = t.tau;
  }
}

TEST(Slave, ARobotThatDoesNotReadHoldsAndKeepsItsTorque) {
  Rig rig;
  rig.engage();
  const Vec6 tau = rig.tick(30).tau;
  rig.robot.ok = false;
  EXPECT_EQ(rig.tick().mode, Mode::holding);
  EXPECT_EQ(rig.tick().tau, tau);
}

TEST(Slave, AFaultStaysUntilTheMasterClutchesWithTheDeadManReleased) {
  Rig rig;
  rig.engage();
  rig.robot.ok = false;
  EXPECT_EQ(rig.tick(51).mode, Mode::fault);
  EXPECT_EQ(rig.tick().out.reason, Reason::silent);
  rig.robot.ok = true;
  rig.release();
  EXPECT_EQ(rig.tick(1000).mode, Mode::fault);
  rig.press();
  ++rig.message.clutch_presses;
  EXPECT_EQ(rig.tick().mode, Mode::fault);
  rig.release();
  EXPECT_EQ(rig.tick().mode, Mode::fault);
  ++rig.message.clutch_presses;
  EXPECT_EQ(rig.tick().mode, Mode::ready);
}

TEST(Slave, ARobotThatDoesNotReadIsNeitherFeltNorFollowed) {
  SlaveConfig config = Rig::default_config();
  config.force_sensing.emplace();
  Rig rig(config);
  rig.engage();
  rig.robot.F_E_S.force = Vec3(10, 0, 0);
  EXPECT_GT(rig.tick(300).out.F_E_M.force.norm(), 5);
  EXPECT_TRUE(rig.tick().out.coupled);
  rig.robot.ok = false;
  const SlaveTick& t = rig.tick();
  EXPECT_FALSE(t.out.coupled);
  EXPECT_EQ(t.out.F_E_M.force.norm(), 0);
  EXPECT_EQ(t.out.V_SE.linear.norm(), 0);
}

TEST(Slave, AfterAFaultTheRobotIsHeldWhereItIsFound) {
  Rig rig;
  rig.engage();
  rig.tick(30);
  rig.robot.ok = false;
  EXPECT_EQ(rig.tick(60).mode, Mode::fault);
  const Vec6 found = kTeleopHome + Vec6::Constant(0.1);  // moved meanwhile
  rig.robot.q = found;
  rig.robot.ok = true;
  EXPECT_EQ(rig.tick().q_cmd, found);
  EXPECT_EQ(rig.tick(100).q_cmd, found);
  EXPECT_EQ(rig.tick().mode, Mode::fault);
}

TEST(Slave, StoppedHoldsTheRobotAndIsFinal) {
  Rig rig;
  rig.engage();
  const Vec6 q = rig.tick(30).q_cmd;
  rig.slave.stop();
  rig.message.p_MH.y() += 0.01;
  EXPECT_EQ(rig.tick(100).mode, Mode::stopped);
  EXPECT_EQ(rig.tick().q_cmd, q);
  rig.release();
  EXPECT_EQ(rig.tick(10).mode, Mode::stopped);
}

TEST(Slave, TheWrenchIsSentOnlyWhereTheSceneSensesForce) {
  Rig without;
  without.robot.F_E_S = {Vec3(1, 2, 3), Vec3::Zero()};
  EXPECT_EQ(without.tick().out.F_E_M.force, Vec3::Zero());
  SlaveConfig config = Rig::default_config();
  config.force_sensing.emplace();
  Rig with(config);
  with.robot.F_E_S = {Vec3(1, 2, 3), Vec3::Zero()};
  EXPECT_EQ(with.tick().out.F_E_M.force, Vec3(-2, 1, 3));
}

}  // namespace
}  // namespace farhand
