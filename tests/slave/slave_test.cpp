#include "slave/slave.hpp"

#include <gtest/gtest.h>

#include "slave/sim_arm.hpp"
#include "tests/support/slave_rig.hpp"

namespace farhand {
namespace {

using std::chrono::milliseconds;
using Rig = SlaveRig;

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
