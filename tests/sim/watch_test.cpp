// A checker that cannot fire proves nothing: each is shown ticks it must refuse.
#include "tests/sim/watch.hpp"

#include <gtest/gtest.h>

#include <numbers>

#include "tests/support/scene_edits.hpp"

namespace farhand {
namespace {

class WatchTest : public ::testing::Test {
 protected:
  static Scene scene() {
    Scene scene = shipped("twin_delta_free");
    scene.proto.mutable_slave()->mutable_workspace()->set_alignment_deg(10);
    return scene;
  }
  WatchTest() : loop_(scene(), {.duration_s = 2}) {
    loop_.on_master = [this](const MasterTick& t) { master_ = t; };
    loop_.on_slave = [this](const SlaveTick& t) { slave_ = t; };
    loop_.run();
    EXPECT_EQ(slave_.mode, Mode::engaged);
  }
  // What the watch says of the last of these ticks, the ones before being good.
  template <typename Tick>
  std::string verdict(const std::vector<Tick>& ticks) {
    Checkers checkers(loop_);
    Watch watch(loop_, checkers, std::chrono::milliseconds(100));
    watch.sampling();
    for (std::size_t i = 0; i < ticks.size(); ++i) {
      EXPECT_EQ(checkers.count(), 0u) << checkers.first().back().what;
      watch.check(ticks[i]);
    }
    return checkers.count() == 0 ? "" : checkers.first().back().what;
  }
  SlaveTick idle() const {
    SlaveTick t = slave_;
    t.mode = Mode::ready;
    t.coupled = false;
    return t;
  }

  Loopback loop_;
  MasterTick master_;
  SlaveTick slave_;
};

TEST_F(WatchTest, AcceptsGenuineTicks) {
  EXPECT_EQ(verdict<SlaveTick>({idle(), slave_}), "");
  MasterTick released = master_;
  released.mode = Mode::ready;
  released.reading.dead_man = false;
  EXPECT_EQ(verdict<MasterTick>({released, master_}), "");
}

TEST_F(WatchTest, RefusesASecondEngagementByTheSamePress) {
  EXPECT_EQ(verdict<SlaveTick>({slave_, idle(), slave_}).substr(0, 33),
            "slave ENGAGED again by the same p");
}

TEST_F(WatchTest, RefusesAMasterEngagedByAPressFromBeforeTheInterruption) {
  MasterTick held = master_, again = master_;
  held.mode = Mode::holding;
  again.now = held.now += std::chrono::milliseconds(1);
  EXPECT_EQ(verdict<MasterTick>({master_, held, again}).substr(0, 32),
            "master ENGAGED by a press older ");
}

TEST_F(WatchTest, RefusesMotionWithoutAFreshOrder) {
  SlaveTick late = slave_;
  late.now += loop_.slave()->config().stale + std::chrono::milliseconds(2);
  EXPECT_EQ(verdict<SlaveTick>({late}).substr(0, 35), "slave ENGAGED without a fresh messa");
  SlaveTick moved = idle();
  moved.q_cmd[1] += 1e-9;
  EXPECT_EQ(verdict<SlaveTick>({idle(), moved}).substr(0, 17), "the command moved");
  SlaveTick coupled = idle();
  coupled.coupled = true;
  EXPECT_EQ(verdict<SlaveTick>({coupled}).substr(0, 11), "coupled but");
}

TEST_F(WatchTest, RefusesWhatIsNotFiniteOrCannotBeSent) {
  SlaveTick s = idle();
  s.X_SE_target.p.x() = NAN;
  EXPECT_EQ(verdict<SlaveTick>({s}).substr(0, 16), "slave not finite");
  s = idle();
  s.out.q_SE = Quat(1, 1, 0, 0);
  EXPECT_EQ(verdict<SlaveTick>({s}).substr(0, 22), "a message of the slave");
}

TEST_F(WatchTest, AFoundRobotMayBeHeldWhereItIsAndNowhereElse) {
  SlaveTick blind = idle(), found = idle();
  blind.robot.ok = false;
  found.robot.q[2] += 0.1;
  found.q_cmd = found.robot.q;
  EXPECT_EQ(verdict<SlaveTick>({idle(), blind, found}), "");
  found.q_cmd[0] += 0.001;
  EXPECT_NE(verdict<SlaveTick>({idle(), blind, found}), "");
}

TEST_F(WatchTest, RefusesACommandFarFromTheRobot) {
  SlaveTick far = idle();
  far.q_cmd[2] += 0.6;
  EXPECT_EQ(verdict<SlaveTick>({far, far, far, far, far}).substr(0, 22), "the command is far fro");
}

// By more than alignment_deg and what it may be off at the edge.
TEST_F(WatchTest, RefusesAHandleThatIsTurnedAway) {
  const Quat q_MH = loop_.slave_end()->newest()->message.q_MH;
  SlaveTick told = idle();
  told.out.has_robot = true;
  for (const double degrees : {11.9, 12.1}) {
    const Vec3 turn(0, degrees * std::numbers::pi / 180, 0);
    told.out.q_MR = to_quat(rotation(turn) * q_MH.toRotationMatrix());
    EXPECT_EQ(verdict<SlaveTick>({told, slave_}).substr(0, 16),
              degrees < 12 ? "" : "coupled with the");
  }
}

}  // namespace
}  // namespace farhand
