// A checker that cannot fire proves nothing: each is shown one tick it must refuse.
#include "tests/loop/checkers.hpp"

#include <gtest/gtest.h>

#include "tests/support/scene_edits.hpp"

namespace farhand {
namespace {

class CheckersTest : public ::testing::Test {
 protected:
  explicit CheckersTest(const std::string& scene = "full")
      : loop_(shipped(scene), {.duration_s = 1}) {
    loop_.on_master = [this](const MasterTick& t) { master_ = t; };
    loop_.on_slave = [this](const SlaveTick& t) { slave_ = t; };
    loop_.run();
  }
  // What the checker says of `bad` after the genuine tick before it.
  template <typename Tick>
  std::string verdict(const Tick& genuine, const Tick& bad) {
    Checkers checkers(loop_);
    Tick first = genuine;
    first.mode = Mode::disconnected;
    checkers.check(first);
    const auto before = checkers.count();
    checkers.check(bad);
    return checkers.count() == before ? "" : checkers.first().back().what;
  }

  Loopback loop_;
  MasterTick master_;
  SlaveTick slave_;
};

MasterTick idle(MasterTick t) {
  t.mode = Mode::disconnected;
  return t;
}
SlaveTick idle(SlaveTick t) {
  t.mode = Mode::disconnected;
  return t;
}

TEST_F(CheckersTest, AcceptGenuineTicks) {
  EXPECT_EQ(verdict(master_, idle(master_)), "");
  EXPECT_EQ(verdict(slave_, idle(slave_)), "");
}

TEST_F(CheckersTest, RefuseIllegalTransitions) {
  MasterTick m = master_;
  m.mode = Mode::engaged;
  EXPECT_NE(verdict(master_, m), "");
  SlaveTick s = slave_;
  s.mode = Mode::holding;
  EXPECT_NE(verdict(slave_, s), "");
}

TEST_F(CheckersTest, RefuseNonFiniteCommands) {
  MasterTick m = idle(master_);
  m.tau[2] = NAN;
  EXPECT_NE(verdict(master_, m), "");
  SlaveTick s = idle(slave_);
  s.tau[5] = INFINITY;
  EXPECT_NE(verdict(slave_, s), "");
}

TEST_F(CheckersTest, RefuseTorquesAndForcesBeyondTheirLimitsAndSlews) {
  MasterTick m = idle(master_);
  m.tau[0] += 1;
  EXPECT_NE(verdict(master_, m), "");
  m = idle(master_);
  m.F_G.force.x() += 2.1;
  EXPECT_NE(verdict(master_, m), "");
  SlaveTick s = idle(slave_);
  s.tau[0] += 4;
  EXPECT_NE(verdict(slave_, s), "");
  s.tau[0] = 61;
  EXPECT_NE(verdict(slave_, s), "");
}

TEST_F(CheckersTest, RefuseJointCommandsOutsideTheLimits) {
  SlaveTick s = idle(slave_);
  s.q_cmd[2] = 2.2;
  EXPECT_EQ(verdict(s, s).substr(0, 21), "joint command outside");
}

class PositionCheckersTest : public CheckersTest {
 protected:
  PositionCheckersTest() : CheckersTest("falcon_cue") {}
};

TEST_F(PositionCheckersTest, RefuseForcesBeyondTheCapAndJumpsOfTheForce) {
  EXPECT_EQ(verdict(master_, idle(master_)), "");
  MasterTick m = idle(master_);
  m.F_G.force.x() += 2.1;
  EXPECT_EQ(verdict(master_, m).substr(0, 10), "force step");
  m = idle(master_);
  m.F_G.force.x() = 8.1;
  EXPECT_NE(verdict(m, m), "");
}

class BoundaryCheckersTest : public CheckersTest {
 protected:
  BoundaryCheckersTest() : CheckersTest("twin_delta_guided") {}
};

TEST_F(BoundaryCheckersTest, RefuseABoundaryThatJumpsOrPushesTooHard) {
  EXPECT_EQ(verdict(slave_, idle(slave_)), "");
  SlaveTick s = idle(slave_);
  s.out.F_E_M.force.y() += 0.6;
  EXPECT_EQ(verdict(slave_, s).substr(0, 10), "force step");
  s.out.F_E_M.force.y() += 8;
  EXPECT_NE(verdict(s, s), "");
}

TEST_F(CheckersTest, RefuseJointCommandsThatLeapOrMoveWhileNotEngaged) {
  SlaveTick s = idle(slave_);
  s.coupled = true;
  s.q_cmd[3] += 0.01;
  EXPECT_NE(verdict(slave_, s), "");
  s = idle(slave_);
  s.coupled = false;
  s.q_cmd[0] += 1e-9;
  EXPECT_EQ(verdict(slave_, s).substr(0, 19), "joint command moved");
}

}  // namespace
}  // namespace farhand
