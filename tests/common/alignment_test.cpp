#include "common/alignment.hpp"

#include <gtest/gtest.h>

#include <numbers>

#include "common/turn_sentence.hpp"

namespace farhand {
namespace {

Vec3 degrees(double x, double y, double z) {
  return Vec3(x, y, z) * (std::numbers::pi / 180);
}

SlaveToMaster told(const Vec3& turn) {
  return {.has_robot = true, .q_MR = to_quat(rotation(turn))};
}

TEST(Alignment, IsThereWithinItsAngleAndLostOnlyBeyondSomeMore) {
  Alignment a(0.1);
  const auto at = [&](double angle) { return a.step(told(Vec3(0, angle, 0)), Quat::Identity()); };
  EXPECT_FALSE(at(0.11));
  EXPECT_TRUE(at(0.099));
  for (int k = 0; k < 100; ++k) EXPECT_TRUE(at(k % 2 == 0 ? 0.119 : 0.081));
  EXPECT_FALSE(at(0.121));
  for (int k = 0; k < 100; ++k) EXPECT_FALSE(at(k % 2 == 0 ? 0.119 : 0.101));
  EXPECT_TRUE(at(0.099));
}

TEST(Alignment, TheTurnBringsTheHandleToTheRobot) {
  Alignment a(0.1);
  const Quat q_MH = to_quat(rotation(Vec3(0.3, -0.8, 0.5)));
  SlaveToMaster robot = told(Vec3(-0.4, 0.2, 1.9));
  EXPECT_FALSE(a.step(robot, q_MH));
  const Quat there = to_quat(rotation(a.turn())) * q_MH;
  EXPECT_LT(there.angularDistance(robot.q_MR), 1e-14);
  robot.q_MR.coeffs() = -robot.q_MR.coeffs();  // the same rotation
  EXPECT_TRUE(a.step(robot, there));
  EXPECT_LT(a.turn().norm(), 1e-14);
}

TEST(Alignment, WhileCoupledAndBeforeTheFirstTimeThereIsNothingToTurn) {
  Alignment a(0.1);
  EXPECT_TRUE(a.step({}, to_quat(rotation(Vec3(1, 0, 0)))));
  EXPECT_EQ(a.turn(), Vec3::Zero());
  EXPECT_FALSE(a.step(told(Vec3(1, 0, 0)), Quat::Identity()));
  SlaveToMaster follows = told(Vec3(1, 0, 0));
  follows.coupled = true;
  EXPECT_TRUE(a.step(follows, Quat::Identity()));
  EXPECT_NEAR(a.turn().x(), 1, 1e-14);  // as it was
}

TEST(TurnSentence, NamesOneAxisOrTheTwoLargest) {
  EXPECT_EQ(turn_sentence(degrees(12, 1, -2)),
            "turn the handle 12 deg about +x (its top to the left)");
  EXPECT_EQ(turn_sentence(degrees(0, -30, 9)),
            "turn the handle 30 deg about -y (its top away from you)");
  EXPECT_EQ(turn_sentence(degrees(-8, 3, -20)),
            "turn the handle 20 deg about -z (clockwise from above) and 8 deg about -x (its top to "
            "the right)");
  EXPECT_EQ(turn_sentence(degrees(5, 4, 3)),
            "turn the handle 5 deg about +x (its top to the left) and 4 deg about +y (its top "
            "towards you)");
  EXPECT_EQ(turn_sentence(degrees(0, 0, 0.2)),
            "turn the handle 1 deg about +z (anticlockwise from above)");
}

// The words are those of a vertical handle seen by the operator: X to him, Y to his right.
TEST(TurnSentence, TheWordsAreTheTurnsOfTheHandlesTop) {
  const Vec3 top(0, 0, 1), front(1, 0, 0);
  EXPECT_LT((rotation(degrees(30, 0, 0)) * top).y(), 0);    // to the left
  EXPECT_GT((rotation(degrees(0, 30, 0)) * top).x(), 0);    // towards you
  EXPECT_GT((rotation(degrees(0, 0, 30)) * front).y(), 0);  // the near side to the right
}

// Who does only what the sentence says, and looks again, gets there.
TEST(TurnSentence, FollowedStepByStepItLeadsToTheRobot) {
  for (int k = 0; k < 200; ++k) {
    Vec3 turn = Vec3(std::sin(k), std::sin(3.7 * k + 1), std::sin(11.3 * k + 2)).normalized();
    turn *= 0.1 + 2.4 * (k % 10) / 10;
    int steps = 0;
    for (Mat3 left = rotation(turn); turn.norm() > degrees(5, 0, 0).norm(); ++steps) {
      Vec3 done = turn;
      const std::string says = turn_sentence(turn);
      for (int axis = 0; axis < 3; ++axis)
        if (says.find(std::string("about ") + (turn[axis] < 0 ? '-' : '+') + "xyz"[axis]) ==
            std::string::npos)
          done[axis] = 0;
      ASSERT_GT(done.norm(), 0) << says;
      left = left * rotation(done).transpose();
      turn = rotation_vector(left);
      ASSERT_LT(steps, 20) << k;
    }
  }
}

TEST(TurnSentence, OtherReasonsKeepTheirs) {
  EXPECT_EQ(sentence(Reason::dead_man_held, degrees(9, 0, 0)), "release the dead-man");
  EXPECT_EQ(sentence(Reason::none, Vec3::Zero()), "");
}

TEST(TurnSentence, WhoWaitsForItIsToldTheOtherWay) {
  const std::string turn = "turn the handle 9 deg about +x (its top to the left)";
  const std::string or_take = ", or press the clutch, dead-man released, to take it as it is";
  EXPECT_EQ(sentence(Reason::turn_handle, degrees(9, 0, 0)), turn + or_take);
  EXPECT_EQ(turning_line(Mode::aligning, Reason::turn_handle, degrees(9, 0, 0)),
            "ALIGNING: " + turn + or_take);
  EXPECT_EQ(turning_line(Mode::engaged, Reason::none, degrees(9, 0, 0)), "ENGAGED: " + turn);
}

}  // namespace
}  // namespace farhand
