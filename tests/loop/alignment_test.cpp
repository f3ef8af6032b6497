// alignment_deg in whole loops: after the dead-man or the clutch was let go and the handle turned
// away, nothing couples it, whatever is pressed, until it is turned back as both sides say.
#include <gtest/gtest.h>

#include <numbers>

#include "common/turn_sentence.hpp"
#include "master/record.hpp"
#include "master/status.hpp"
#include "slave/record.hpp"
#include "tests/loop/checkers.hpp"
#include "tests/loop/loopback.hpp"
#include "tests/support/scene_edits.hpp"

namespace farhand::alignment_test {
namespace {

constexpr double kDegree = std::numbers::pi / 180;
constexpr double kWithin = 10;  // [deg]

void turn(proto::Motion& m, double at, double about_x) {
  proto::Reach& r = *m.add_reach();
  r.set_at_s(at);
  r.set_lasting_s(1);
  for (const double degrees : {about_x, 0.0, 0.0}) r.add_turn_deg(degrees);
}

// Coupled at first, turned by -10 deg, let go at 2.5 s, turned by 30 deg up to 4 s, and back by 27
// up to 8 s.
Scene turning(const char* name) {
  Scene scene = shipped(name);
  scene.proto.mutable_slave()->mutable_workspace()->set_alignment_deg(kWithin);
  scene.proto.mutable_slave()->mutable_sim_arm()->clear_surface();
  scene.proto.set_duration_s(11);
  proto::Operator& o = hand(scene);
  o.clear_press();
  o.mutable_motion()->Clear();
  turn(*o.mutable_motion(), 1, -10);
  turn(*o.mutable_motion(), 3, 30);
  turn(*o.mutable_motion(), 7, -27);
  return scene;
}

struct Seen {
  MasterTick master;
  SlaveTick slave;
};

// Of the whole run, and the ticks of the given instants [s].
struct Watched {
  std::vector<Seen> at;
  MasterSummary master;
  double coupled_again = -1;  // [s]
  double step = 0;            // [rad] of the joint command in the 5 ms then
  double off = 0;             // [rad] of the tool from the handle then, by the first coupling
};

Watched watch(const Scene& scene, const std::vector<double>& instants) {
  Loopback loop(scene, {});
  Checkers checkers(loop);
  Watched out;
  Seen now;
  std::optional<Mat3> R_first;  // tool as if held by the handle
  Vec6 q_cmd;
  loop.on_master = [&](const MasterTick& t) {
    checkers.check(t);
    out.master.add(t);
    now.master = t;
  };
  loop.on_slave = [&](const SlaveTick& t) {
    checkers.check(t);
    const double at = seconds(loop.now() - loop.start());
    const Mat3 R_SM = loop.slave()->config().workspace.R_SM;
    const auto* in = loop.slave_end()->newest();
    if (t.coupled && !now.slave.coupled) {
      const Mat3 R = (R_SM * in->message.q_MH.toRotationMatrix()).transpose() *
                     forward(loop.slave()->config().arm, t.q_cmd).R;
      if (R_first) {
        out.coupled_again = at;
        out.off = rotation_vector(R * R_first->transpose()).norm();
        q_cmd = now.slave.q_cmd;
      } else {
        R_first = R;
      }
    }
    if (out.coupled_again > 0 && at < out.coupled_again + 0.005)
      out.step = std::max(out.step, (t.q_cmd - q_cmd).cwiseAbs().maxCoeff());
    now.slave = t;
  };
  for (const double instant : instants) {
    loop.run_until(loop.start() + from_seconds(instant));
    out.at.push_back(now);
  }
  loop.run();
  EXPECT_EQ(checkers.count(), 0u);
  for (const Violation& v : checkers.first()) ADD_FAILURE() << v.at_s << " s: " << v.what;
  return out;
}

void expect_turning(const Seen& s) {
  for (const Reason reason : {s.master.reason, s.slave.reason})
    EXPECT_EQ(reason, Reason::turn_handle);
  EXPECT_EQ(s.master.mode, Mode::aligning);
  EXPECT_EQ(s.slave.mode, Mode::aligning);
  EXPECT_FALSE(s.slave.coupled);
  for (const Vec3& turn_M : {s.master.turn_M, s.slave.turn_M})
    EXPECT_EQ(turn_sentence(turn_M).substr(0, 35), "turn the handle 30 deg about -x (it");
  EXPECT_EQ(s.master.F_G.force.norm() + s.master.F_G.torque.norm(), 0);  // the hand is free
}

void expect_parallel(const char* what, const Watched& w, double from) {
  std::printf(
      "%s: coupled again at %.3f s, tool off parallel by %.2f deg, joints moved %.2e rad in 5 ms\n",
      what, w.coupled_again, w.off / kDegree, w.step);
  EXPECT_GT(w.coupled_again, from);
  EXPECT_LT(w.coupled_again, from + 0.5);
  EXPECT_LE(w.off, kWithin * kDegree);
  EXPECT_GT(w.off, 0.2 * kDegree);
  // What the hand still moves in that time; the angle itself would be 0.05 rad.
  EXPECT_LT(w.step, 1e-3);
}

TEST(AlignmentLoop, AfterTheDeadManTheHandleIsTurnedBackFirst) {
  for (const char* name : {"twin_delta_free", "twin_delta_far"}) {
    Scene scene = turning(name);
    press(hand(scene), proto::Press::DEAD_MAN, 0.5, 2);
    press(hand(scene), proto::Press::DEAD_MAN, 5, 1);
    press(hand(scene), proto::Press::DEAD_MAN, 9, 10);
    const Watched w = watch(scene, {2, 2.9, 4.8, 5.9, 8.5, 10});
    EXPECT_TRUE(w.at[0].slave.coupled);
    EXPECT_EQ(w.at[1].master.mode, Mode::ready);
    expect_turning(w.at[2]);
    expect_turning(w.at[3]);  // pressed
    EXPECT_TRUE(w.at[3].master.reading.dead_man);
    EXPECT_EQ(w.at[3].slave.q_cmd, w.at[2].slave.q_cmd);
    EXPECT_EQ(w.at[4].master.mode, Mode::ready);
    EXPECT_EQ(w.at[5].master.mode, Mode::engaged);
    EXPECT_TRUE(w.at[5].slave.coupled);
    expect_parallel(name, w, 9);
    EXPECT_NE(summary_rows(w.master).find("handle to be turned"), std::string::npos);
  }
}

TEST(AlignmentLoop, AfterTheClutchItIsTurnedBackAndTheDeadManPressedAgain) {
  for (const char* name : {"twin_delta_free", "twin_delta_far"}) {
    Scene scene = turning(name);
    press(hand(scene), proto::Press::DEAD_MAN, 0.5, 8);
    press(hand(scene), proto::Press::CLUTCH, 2.5, 2);
    press(hand(scene), proto::Press::DEAD_MAN, 9, 10);
    const Watched w = watch(scene, {2.9, 4.4, 5.5, 8.4, 8.8, 10});
    EXPECT_EQ(w.at[0].master.mode, Mode::engaged);
    EXPECT_EQ(w.at[1].master.mode, Mode::engaged);  // clutch held: shown, and no more
    EXPECT_FALSE(w.at[1].master.aligned);
    expect_turning(w.at[2]);
    EXPECT_TRUE(w.at[2].master.reading.dead_man);
    EXPECT_EQ(w.at[3].master.reason, Reason::dead_man_held);
    EXPECT_EQ(w.at[3].slave.q_cmd, w.at[0].slave.q_cmd);
    EXPECT_EQ(w.at[4].master.mode, Mode::ready);
    EXPECT_TRUE(w.at[5].slave.coupled);
    expect_parallel(name, w, 9);
  }
}

TEST(AlignmentLoop, APressOfTheClutchTakesTheHandleAsItIs) {
  for (const char* name : {"twin_delta_free", "twin_delta_far"}) {
    Scene scene = turning(name);
    press(hand(scene), proto::Press::DEAD_MAN, 0.5, 2);
    press(hand(scene), proto::Press::CLUTCH, 5, 0.3);
    press(hand(scene), proto::Press::DEAD_MAN, 6, 0.8);
    const Watched w = watch(scene, {4.8, 5.9, 6.7, 6.9, 8.5});
    expect_turning(w.at[0]);
    EXPECT_EQ(w.at[1].master.mode, Mode::ready);
    EXPECT_FALSE(w.at[1].slave.coupled);
    EXPECT_TRUE(w.at[2].slave.coupled);
    EXPECT_NEAR(w.off, 30 * kDegree, 0.5 * kDegree);  // as it was turned away
    EXPECT_LT(w.step, 1e-3);
    EXPECT_EQ(w.at[3].master.mode, Mode::ready);  // and that is parallel now
    EXPECT_EQ(w.at[4].master.reason, Reason::turn_handle);
  }
}

// The clutch let go with the handle as it was needs no press.
TEST(AlignmentLoop, TheClutchGoesOnAtOnceWithTheHandleParallel) {
  Scene scene = turning("twin_delta_free");
  press(hand(scene), proto::Press::DEAD_MAN, 0.5, 20);
  press(hand(scene), proto::Press::CLUTCH, 2.5, 6);
  const Watched w = watch(scene, {4.5, 8.4, 10});
  EXPECT_FALSE(w.at[0].master.aligned);
  EXPECT_TRUE(w.at[1].master.aligned);
  EXPECT_EQ(w.at[2].slave.mode, Mode::engaged);
  expect_parallel("clutch", w, 8.5);
  EXPECT_EQ(w.master.turn_ticks, 0u);
}

TEST(AlignmentLoop, ASlaveThatIsStartedAgainTakesTheHandleAsItIsAndAMasterTurnsIt) {
  for (const Side side : {Side::master, Side::slave}) {
    Scene scene = turning("twin_delta_free");
    press(hand(scene), proto::Press::DEAD_MAN, 0.5, 2);
    press(hand(scene), proto::Press::DEAD_MAN, 6, 0.9);
    Loopback loop(scene, {});
    Checkers checkers(loop);
    bool coupled = false;
    Mode mode = Mode::disconnected;
    loop.on_master = [&](const MasterTick& t) { checkers.check(t), mode = t.mode; };
    loop.on_slave = [&](const SlaveTick& t) { checkers.check(t), coupled = t.coupled; };
    loop.run_until(loop.start() + from_seconds(4.5));
    EXPECT_EQ(mode, Mode::aligning);
    loop.restart(side, std::chrono::milliseconds(200), 7);
    checkers.restarted(side);
    loop.run_until(loop.start() + from_seconds(6.8));
    EXPECT_EQ(coupled, side == Side::slave);
    EXPECT_EQ(mode, side == Side::slave ? Mode::engaged : Mode::aligning);
    EXPECT_EQ(checkers.count(), 0u);
  }
}

TEST(AlignmentLoop, TheAngleIsRecordedWhereTheSceneHasIt) {
  Scene scene = turning("twin_delta_free");
  press(hand(scene), proto::Press::DEAD_MAN, 0.5, 2);
  const Watched w = watch(scene, {4.8});
  const Seen& s = w.at[0];
  SlaveConfig slave = slave_config(scene.proto);
  record::MasterRecord of_master, of_master_without;
  record::SlaveRecord of_slave, of_slave_without;
  MasterRecord master_tick;
  SlaveRecord slave_tick;
  master_tick.tick = s.master, slave_tick.tick = s.slave;
  fill(of_master, master_tick, {.aligns = true});
  fill(of_slave, slave_tick, slave);
  EXPECT_NEAR(of_master.handle_turn_m_rad(0), -30 * kDegree, 0.5 * kDegree);
  EXPECT_NEAR(of_slave.handle_turn_m_rad(0), of_master.handle_turn_m_rad(0), 1e-5);
  slave.workspace.alignment.reset();
  fill(of_master_without, master_tick, {});
  fill(of_slave_without, slave_tick, slave);
  EXPECT_EQ(of_master_without.handle_turn_m_rad_size(), 0);
  EXPECT_EQ(of_slave_without.handle_turn_m_rad_size(), 0);
}

}  // namespace
}  // namespace farhand::alignment_test
