// The link is cut at random moments of a motion: the robot holds within stale_ms and a tick of the
// last message, its command stops there, and whatever comes back, nothing moves before the dead-man
// was released and pressed again. A second a cycle; FARHAND_STRESS_TICKS: how many cycles.
#include <gtest/gtest.h>

#include "common/random.hpp"
#include "tests/loop/checkers.hpp"
#include "tests/loop/loopback.hpp"
#include "tests/support/scene_edits.hpp"
#include "tests/support/stress.hpp"

namespace farhand {
namespace {

using std::chrono::milliseconds;

// Within a cycle [s]: pressed from here to there, cut somewhere between, back before the release.
constexpr double kPress = 0.1, kFirstCut = 0.25, kLastCut = 0.6, kRelease = 0.9;

Scene moving() {
  Scene scene = shipped("twin_delta_free");
  hand(scene).clear_press();
  proto::Motion& m = *hand(scene).mutable_motion();
  m.Clear();
  proto::Sine& s = *m.add_sine();
  s.set_frequency_hz(1.3);
  for (const double a : {0.02, 0.03, 0.02}) s.add_amplitude_m(a);
  return scene;
}

// What one run of many cycles saw.
struct Seen {
  std::uint64_t cuts = 0, held = 0, engaged = 0;
  Duration latest{};          // from the last message that the slave heard to HOLDING
  double path = 0;            // [m] that the tool went on, at most, and
  double beyond = -1;         // by how much more than v^2 / 2a from its speed then
  std::uint64_t resumed = 0;  // engaged by a press older than the cut
};

class Cutter {
 public:
  explicit Cutter(std::uint64_t seed) : random_(seed) { plan(0); }

  bool cut(double t) const { return t >= begin_ && t < end_; }
  bool dead_man(double in_cycle) const { return in_cycle >= kPress && in_cycle < kRelease; }
  void plan(std::uint64_t cycle) {
    const double start = static_cast<double>(cycle);
    begin_ = start + kFirstCut + (kLastCut - kFirstCut) * random_.uniform();
    end_ = begin_ + 0.03 + 0.2 * random_.uniform();  // some within lost_ms, all beyond stale_ms
  }

 private:
  Random random_;
  double begin_ = 0, end_ = 0;
};

Seen run(std::uint64_t cycles) {
  Scene scene = moving();
  Loopback loop(scene, {.duration_s = static_cast<double>(cycles)});
  Checkers checkers(loop);
  Cutter cutter(7);
  Seen seen;
  std::uint64_t cycle = 0;
  bool was_cut = false, stopped = false;
  Mode before = Mode::disconnected;
  Vec3 p_held = Vec3::Zero();
  double v_held = 0;
  const auto at = [&] { return seconds(loop.now() - loop.start()); };
  loop.on_reading = [&](HandleReading& r) {
    const double t = at();
    if (static_cast<std::uint64_t>(t) != cycle) {
      cycle = static_cast<std::uint64_t>(t);
      cutter.plan(cycle);
      stopped = false;
    }
    r.dead_man = cutter.dead_man(t - static_cast<double>(cycle));
    if (cutter.cut(t) && !was_cut) ++seen.cuts;
    was_cut = cutter.cut(t);
    loop.cut(was_cut);
  };
  loop.on_master = [&](const MasterTick& t) { checkers.check(t); };
  loop.on_slave = [&](const SlaveTick& t) {
    checkers.check(t);
    seen.engaged += t.mode == Mode::engaged && before != Mode::engaged;
    if (t.mode == Mode::holding && before == Mode::engaged) {
      ++seen.held;
      stopped = true;
      seen.latest = std::max(seen.latest, t.age);
      p_held = t.X_SE.p;
      v_held = t.out.V_SE.linear.norm();
    }
    if (stopped) {
      seen.resumed += t.mode == Mode::engaged || t.coupled;
      constexpr double kBraking = 5;  // [m/s^2] a robot of this size stops with
      const double path = (t.X_SE.p - p_held).norm();
      seen.path = std::max(seen.path, path);
      seen.beyond = std::max(seen.beyond, path - v_held * v_held / (2 * kBraking));
    }
    before = t.mode;
  };
  loop.run();
  EXPECT_EQ(checkers.count(), 0u);
  return seen;
}

TEST(LinkCut, HoldsWithinTheLimitAndMovesOnlyAfterAFreshPress) {
  const std::uint64_t cycles = stress_ticks(400);
  const Seen s = run(cycles);
  const Duration stale = milliseconds(20);  // the scene's
  std::printf(
      "%lu cuts: held %lu times, at most %.3f ms after the last message heard; the tool went on by "
      "%.2f mm at most; engaged %lu times, by an old press %lu\n",
      s.cuts, s.held, seconds(s.latest) * 1e3, s.path * 1e3, s.engaged, s.resumed);
  EXPECT_GE(s.cuts, cycles - 1);
  EXPECT_EQ(s.held, s.cuts);
  EXPECT_LE(s.latest, stale + milliseconds(1));
  EXPECT_LE(s.beyond, 0.001);
  EXPECT_EQ(s.resumed, 0u);
  EXPECT_GE(s.engaged, cycles - 1);
}

}  // namespace
}  // namespace farhand
