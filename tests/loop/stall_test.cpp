// The slave stalls in the middle of a motion while the master, which bears long pauses, goes on.
// When it wakes, what waited for it is of the past: it must not move the robot.
#include <gtest/gtest.h>

#include "tests/loop/loopback.hpp"
#include "tests/support/scene_edits.hpp"

namespace farhand::stall_test {
namespace {

using std::chrono::milliseconds;
using std::chrono::seconds;

constexpr double kStall = 1.0, kRelease = 4.0, kPressAgain = 4.5;  // [s]

// Both sides bear pauses of 300 ms; the hand keeps moving.
Scene moving(double max_late_ms) {
  Scene scene = shipped("twin_delta_free");
  scene.proto.mutable_link()->set_stale_ms(300);
  scene.proto.mutable_link()->set_max_late_ms(max_late_ms);
  proto::Operator& o = hand(scene);
  o.clear_press();
  press(o, proto::Press::DEAD_MAN, 0.3, kRelease - 0.3);
  press(o, proto::Press::DEAD_MAN, kPressAgain, 100);
  o.mutable_motion()->Clear();
  proto::Sine& s = *o.mutable_motion()->add_sine();
  s.set_frequency_hz(1.3);
  for (const double a : {0.01, 0.02, 0.01}) s.add_amplitude_m(a);
  return scene;
}

struct Seen {
  bool engaged_before = false, engaged_after = false;  // the stall; the second press
  std::uint64_t moved = 0;  // ticks between, with another command than when it stalled
  std::uint64_t too_late = 0;
};

Seen run(double max_late_ms, Duration stall) {
  Loopback loop(moving(max_late_ms), {.duration_s = 6});
  Seen seen;
  Vec6 q_stalled = Vec6::Zero();
  loop.on_slave = [&](const SlaveTick& t) {
    const double at = farhand::seconds(t.now - loop.start());
    if (at < kStall) q_stalled = t.q_cmd;
    if (at < kStall) seen.engaged_before = t.mode == Mode::engaged;
    if (at >= kStall && at < kPressAgain) seen.moved += t.q_cmd != q_stalled;
    if (at > kPressAgain) seen.engaged_after = t.mode == Mode::engaged;
  };
  loop.run_until(loop.start() + from_seconds(kStall));
  loop.stall(Side::slave, stall);
  loop.run();
  seen.too_late = (*loop.slave_link())[Verdict::too_late];
  return seen;
}

TEST(Stall, WhatWaitedMeanwhileMovesNothing) {
  const Seen s = run(300, seconds(2));
  EXPECT_TRUE(s.engaged_before && s.engaged_after);
  EXPECT_EQ(s.moved, 0u);
  EXPECT_EQ(s.too_late, SocketQueue::kMost);  // the oldest: the rest found no room
}

TEST(Stall, WithoutTheLimitItWould) {
  const Seen s = run(10000, seconds(2));
  EXPECT_TRUE(s.engaged_before && s.engaged_after);
  EXPECT_GT(s.moved, 0u);
  EXPECT_EQ(s.too_late, 0u);
}

// Shorter than any limit: the motion goes on.
TEST(Stall, AShortOneIsBorne) {
  const Seen s = run(300, milliseconds(60));
  EXPECT_TRUE(s.engaged_before && s.engaged_after);
  EXPECT_GT(s.moved, 0u);
  EXPECT_EQ(s.too_late, 0u);
}

}  // namespace
}  // namespace farhand::stall_test
