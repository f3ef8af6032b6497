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
  for (const double a : {0.01, 0.02, 0.01}) s.add_amplitude_m(a);
  return scene;
}

// What one run of many cycles saw.
struct Seen {
  std::uint64_t cuts = 0, held = 0, engaged = 0;
  Duration latest{};          // from the last message that the slave heard to HOLDING
  double path = 0;            // [m] that the tool went on by its servo's lag, at most
  std::uint64_t resumed = 0;  // ticks engaged by a press older than the cut, and
  std::uint64_t moved = 0;    // ticks with another command than when it began to hold

  void add(const Seen& o) {
    cuts += o.cuts, held += o.held, engaged += o.engaged, resumed += o.resumed, moved += o.moved;
    latest = std::max(latest, o.latest), path = std::max(path, o.path);
  }
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

Seen run(std::uint64_t seed, std::uint64_t cycles) {
  Scene scene = moving();
  Loopback loop(scene, {.duration_s = static_cast<double>(cycles)});
  Checkers checkers(loop);
  Cutter cutter(seed);
  Seen seen;
  std::uint64_t cycle = 0;
  bool was_cut = false, stopped = false;
  Mode before = Mode::disconnected;
  Vec3 p_held = Vec3::Zero();
  Vec6 q_held = Vec6::Zero();
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
      q_held = t.q_cmd;
    }
    if (stopped) {
      seen.resumed += t.mode == Mode::engaged || t.coupled;
      seen.moved += t.q_cmd != q_held;
      seen.path = std::max(seen.path, (t.X_SE.p - p_held).norm());
    }
    before = t.mode;
  };
  loop.run();
  EXPECT_EQ(checkers.count(), 0u);
  for (const Violation& v : checkers.first()) ADD_FAILURE() << v.at_s << " s: " << v.what;
  return seen;
}

TEST(LinkCut, HoldsWithinTheLimitAndMovesOnlyAfterAFreshPress) {
  // Each coupling begins where the last one ended: after some cycles the arm would be at its
  // limits.
  constexpr std::uint64_t kCycles = 20;
  const std::uint64_t cycles = stress_ticks(400) / kCycles * kCycles;
  Seen s;
  for (std::uint64_t seed = 1; seed <= cycles / kCycles; ++seed) s.add(run(seed, kCycles));
  const Duration stale = milliseconds(20);  // the scene's
  std::printf(
      "%lu cuts: held %lu times, at most %.3f ms after the last message heard; the command stopped "
      "at once but for %lu ticks, the tool within %.2f mm; engaged %lu times, by an old press "
      "%lu\n",
      s.cuts, s.held, seconds(s.latest) * 1e3, s.moved, s.path * 1e3, s.engaged, s.resumed);
  EXPECT_EQ(s.cuts, cycles);
  EXPECT_EQ(s.held, s.cuts);
  EXPECT_LE(s.latest, stale + milliseconds(1));
  EXPECT_EQ(s.moved, 0u);
  EXPECT_EQ(s.resumed, 0u);
  EXPECT_EQ(s.engaged, cycles);
}

}  // namespace
}  // namespace farhand
