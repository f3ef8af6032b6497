// What the master does with a handle that does not read, or reads what cannot be.
#include <gtest/gtest.h>

#include "tests/support/master_rig.hpp"

namespace farhand {
namespace {

using Rig = MasterRig;

TEST(MasterReadings, ADeviceThatDoesNotReadReleasesTheMotors) {
  Rig rig;
  rig.answer.F_E_M.force = Vec3(4, 0, 0);
  rig.engage();
  EXPECT_GT(rig.tick(50).tau.norm(), 0.01);
  rig.reading.ok = false;
  EXPECT_EQ(rig.tick().mode, Mode::holding);
  EXPECT_EQ(rig.tick().reason, Reason::silent);
  EXPECT_EQ(rig.tick(50).tau, Vec6::Zero());
}

TEST(MasterReadings, AFaultStaysUntilTheClutchIsPressedWithTheDeadManReleased) {
  Rig rig;
  rig.answer.F_E_M.force = Vec3(4, 0, 0);
  rig.engage();
  rig.tick(50);
  rig.reading.ok = false;
  EXPECT_EQ(rig.tick(50).mode, Mode::holding);
  EXPECT_EQ(rig.tick().mode, Mode::fault);
  EXPECT_EQ(rig.sent.reason, Reason::silent);
  rig.reading.ok = true;
  rig.reading.dead_man = false;
  EXPECT_EQ(rig.tick(1000).mode, Mode::fault);
  EXPECT_EQ(rig.tick().tau, Vec6::Zero());
  rig.reading.dead_man = true;
  rig.reading.clutch = true;
  EXPECT_EQ(rig.tick(2).mode, Mode::fault);
  rig.reading.dead_man = false;
  EXPECT_EQ(rig.tick(2).mode, Mode::fault);  // a fresh press it must be
  rig.reading.clutch = false;
  rig.tick();
  rig.reading.clutch = true;
  EXPECT_EQ(rig.tick().mode, Mode::ready);
}

TEST(MasterReadings, AnglesThatNoHandleCanHaveKeepTheLastPoseAndHold) {
  Rig rig;
  rig.engage();
  const Vec3 p = rig.sent.p_MH;
  rig.reading.theta << 1.371, -1.007, 0.061, 0.377, -2.157, -1.430;  // the forearms do not meet
  EXPECT_EQ(rig.tick(1000).mode, Mode::holding);  // moved back it goes on: no fault
  EXPECT_EQ(rig.sent.reason, Reason::outside);
  EXPECT_EQ(rig.sent.p_MH, p);
  rig.reading.theta = Vec6::Constant(NAN);
  EXPECT_EQ(rig.tick().mode, Mode::holding);
  EXPECT_TRUE(rig.tick().tau.allFinite());
  EXPECT_EQ(rig.tick(50).mode, Mode::fault);
  EXPECT_EQ(rig.sent.reason, Reason::implausible);
}

// An encoder's slip: the robot is not driven there, nor the hand pushed.
TEST(MasterReadings, AnArmThatLeapsIsNoReading) {
  for (const int joint : {0, 2, 5}) {
    Rig rig;
    rig.engage();
    const Vec6 theta = rig.reading.theta;
    const Vec3 p = rig.sent.p_MH;
    rig.reading.theta[joint] = theta[joint] + 0.2;
    EXPECT_EQ(rig.tick().mode, Mode::holding);
    EXPECT_EQ(rig.sent.reason, Reason::implausible);
    EXPECT_EQ(rig.sent.p_MH, p);
    rig.reading.theta = theta;
    EXPECT_EQ(rig.tick().reason, Reason::implausible);  // back again is a leap, too
    rig.tick();
    EXPECT_EQ(rig.sent.mode, Mode::holding);
    EXPECT_NE(rig.sent.reason, Reason::implausible);
    EXPECT_EQ(rig.sent.p_MH, p);
    EXPECT_EQ(rig.sent.V_MH.linear, Vec3::Zero());
  }
}

TEST(MasterReadings, WhereALeapStaysTheHandleIsThereAndNothingLedThere) {
  Rig rig;
  rig.engage();
  const Vec3 p = rig.sent.p_MH;
  rig.reading.theta += Vec6::Constant(0.2);
  rig.tick(2);
  EXPECT_GT((rig.sent.p_MH - p).norm(), 0.005);
  EXPECT_EQ(rig.sent.V_MH.linear, Vec3::Zero());
  EXPECT_EQ(rig.sent.mode, Mode::holding);
}

// What a hand can do, 2 m/s at an arm of 0.1 m, is none.
TEST(MasterReadings, AFastHandIsBelieved) {
  Rig rig;
  rig.engage();
  for (int k = 0; k < 15; ++k) {
    rig.reading.theta += Vec6::Constant(0.02);
    ASSERT_EQ(rig.tick().mode, Mode::engaged) << k;
  }
}

}  // namespace
}  // namespace farhand
