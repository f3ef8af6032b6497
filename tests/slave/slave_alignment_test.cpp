// The slave couples no handle that is turned away from the robot.
#include <gtest/gtest.h>

#include "tests/support/slave_rig.hpp"

namespace farhand {
namespace {

using std::chrono::milliseconds;
using Rig = SlaveRig;

Quat turned(double x, double y = 0, double z = 0) {
  return to_quat(rotation(Vec3(x, y, z)));
}

SlaveConfig aligning() {
  SlaveConfig config = Rig::default_config();
  config.workspace.alignment = 0.1;
  return config;
}

TEST(SlaveAlignment, ALaterCouplingWaitsUntilTheHandleIsTurnedBack) {
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
TEST(SlaveAlignment, WhatIsLeftOfTheAngleDoesNotAddUpOverManyCouplings) {
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

TEST(SlaveAlignment, UnderTheClutchTheHandleMayBeTurnedAwayAndBack) {
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

TEST(SlaveAlignment, AMasterThatIsStartedAgainMustTurnTheHandleAndARobotFoundElsewhereNeedNot) {
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

TEST(SlaveAlignment, APressOfTheClutchTakesTheHandleAsItIs) {
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

TEST(SlaveAlignment, APressMeantForSomethingElseDoesNotTakeTheHandle) {
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

TEST(SlaveAlignment, WithoutAlignmentAnyHandleIsCoupledAndAnUncoupledRobotNotTold) {
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

}  // namespace
}  // namespace farhand
