// What the slave does with a robot that does not read, or reads what cannot be.
#include <gtest/gtest.h>

#include <limits>

#include "tests/support/slave_rig.hpp"

namespace farhand {
namespace {

using std::chrono::milliseconds;
using Rig = SlaveRig;

TEST(SlaveReadings, AReadingThatCannotBeIsNoReading) {
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

TEST(SlaveReadings, AJointThatLeapsIsNoReadingAndLeavesTheCommandAlone) {
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
TEST(SlaveReadings, WhereALeapStaysTheRobotIsHeldAndNotDrivenBack) {
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

TEST(SlaveReadings, ClutchPressesOfAMasterNotHeardYetClearNoFault) {
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
TEST(SlaveReadings, AWrongReadingDoesNotSayWhereTheRobotIsFound) {
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

TEST(SlaveReadings, ARobotThatDoesNotReadHoldsAndKeepsItsTorque) {
  Rig rig;
  rig.engage();
  const Vec6 tau = rig.tick(30).tau;
  rig.robot.ok = false;
  EXPECT_EQ(rig.tick().mode, Mode::holding);
  EXPECT_EQ(rig.tick().tau, tau);
}

TEST(SlaveReadings, AFaultStaysUntilTheMasterClutchesWithTheDeadManReleased) {
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

TEST(SlaveReadings, ARobotThatDoesNotReadIsNeitherFeltNorFollowed) {
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

TEST(SlaveReadings, AfterAFaultTheRobotIsHeldWhereItIsFound) {
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

}  // namespace
}  // namespace farhand
