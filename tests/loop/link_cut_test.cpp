// The link is cut at random moments of a motion, one way or both: the side that hears nothing holds
// within stale_ms and a tick of the last message, the robot's command stops with it, and whatever
// comes back, nothing moves before the dead-man was released and pressed again. A cut a cycle;
// FARHAND_STRESS_TICKS: how many of them.
#include <gtest/gtest.h>

#include "common/random.hpp"
#include "tests/loop/checkers.hpp"
#include "tests/loop/loopback.hpp"
#include "tests/support/scene_edits.hpp"
#include "tests/support/stress.hpp"

namespace farhand {
namespace {

using std::chrono::milliseconds;

// Of a cycle [s]: pressed from here to there, cut somewhere between, back before the release.
constexpr double kCycle = 1.5, kPress = 0.3, kFirstCut = 0.6, kLastCut = 0.9, kRelease = 1.4;
constexpr Duration kTick = milliseconds(1);

struct Network {
  const char* scene;
  double delay_ms;  // each way
  int stale_ms;
};
constexpr std::array<Network, 3> kNetworks = {
    {{"twin_delta_free", 0.05, 20}, {"twin_delta_free", 20, 20}, {"twin_delta_far", 45, 100}}};

Scene moving(const Network& n) {
  Scene scene = shipped(n.scene);
  proto::Link& link = *scene.proto.mutable_link();
  link.set_stale_ms(n.stale_ms);
  for (proto::Impairment* way : {link.mutable_to_slave(), link.mutable_to_master()}) {
    way->Clear();
    way->set_delay_ms(n.delay_ms);
  }
  hand(scene).clear_press();
  proto::Motion& m = *hand(scene).mutable_motion();
  m.Clear();
  proto::Sine& s = *m.add_sine();
  s.set_frequency_hz(1.3);
  for (const double a : {0.01, 0.02, 0.01}) s.add_amplitude_m(a);
  return scene;
}

// What runs of many cycles saw.
struct Seen {
  std::uint64_t cuts = 0, engaged = 0, stopped = 0;
  std::uint64_t deaf = 0, held = 0;        // sides that a cut made deaf; that held for it
  Duration latest{};                       // from the last message that a side heard to its HOLDING
  std::uint64_t resumed = 0;               // ticks engaged by a press older than the cut
  double command_path = 0, tool_path = 0;  // [m] gone on after the slave stopped, at most

  void add(const Seen& o) {
    cuts += o.cuts, engaged += o.engaged, stopped += o.stopped, deaf += o.deaf, held += o.held;
    resumed += o.resumed, latest = std::max(latest, o.latest);
    command_path = std::max(command_path, o.command_path);
    tool_path = std::max(tool_path, o.tool_path);
  }
};

class Cutter {
 public:
  Cutter(std::uint64_t seed, double stale) : random_(seed), stale_(stale) { plan(0); }

  void plan(std::uint64_t cycle) {
    start_ = kCycle * static_cast<double>(cycle);
    begin_ = start_ + kFirstCut + (kLastCut - kFirstCut) * random_.uniform();
    end_ = begin_ + stale_ + 0.01 + 0.2 * random_.uniform();
    const auto ways = 1 + random_.bits() % 3;
    to_slave_ = ways != 2, to_master_ = ways != 1;
  }
  bool cut(double t) const { return t >= begin_ && t < end_; }
  bool to_slave() const { return to_slave_; }
  bool to_master() const { return to_master_; }
  bool dead_man(double t) const { return t - start_ >= kPress && t - start_ < kRelease; }

 private:
  Random random_;
  double stale_, start_ = 0, begin_ = 0, end_ = 0;
  bool to_slave_ = true, to_master_ = true;
};

class Cuts {
 public:
  Cuts(const Network& network, std::uint64_t seed, std::uint64_t cycles)
      : loop_(moving(network), {.duration_s = kCycle * static_cast<double>(cycles)}),
        checkers_(loop_),
        cutter_(seed, 1e-3 * network.stale_ms) {
    loop_.on_reading = [this](HandleReading& r) { press(r); };
    loop_.on_master = [this](const MasterTick& t) { on(t); };
    loop_.on_slave = [this](const SlaveTick& t) { on(t); };
  }
  Seen run() {
    loop_.run();
    EXPECT_EQ(checkers_.count(), 0u);
    for (const Violation& v : checkers_.first()) ADD_FAILURE() << v.at_s << " s: " << v.what;
    return seen_;
  }

 private:
  void press(HandleReading& r) {
    const double t = seconds(loop_.now() - loop_.start());
    if (const auto cycle = static_cast<std::uint64_t>(t / kCycle); cycle != cycle_) {
      cutter_.plan(cycle_ = cycle);
      cut_done_ = stopped_ = false;
    }
    r.dead_man = pressed_ = cutter_.dead_man(t);
    const bool cut = cutter_.cut(t);
    if (rises(cut, cut_)) {
      cut_done_ = true;
      ++seen_.cuts;
      seen_.deaf += cutter_.to_slave() + cutter_.to_master();
    }
    loop_.cut(cut && cutter_.to_slave(), cut && cutter_.to_master());
  }
  void held(Duration after) {
    ++seen_.held;
    seen_.latest = std::max(seen_.latest, after);
  }
  void on(const MasterTick& t) {
    checkers_.check(t);
    // It decided before it heard whatever has come in since.
    if (t.mode == Mode::holding && master_mode_ == Mode::engaged && t.reason == Reason::link_old)
      held(t.now - loop_.master_end().newest()->received);
    master_mode_ = t.mode;
  }
  void on(const SlaveTick& t) {
    checkers_.check(t);
    const Vec3 p_cmd = forward(loop_.slave()->config().arm, t.q_cmd).p;
    seen_.engaged += t.mode == Mode::engaged && slave_mode_ != Mode::engaged;
    if (slave_mode_ == Mode::engaged && t.mode != Mode::engaged && cut_done_ && pressed_) {
      if (t.mode == Mode::holding) held(t.age);
      ++seen_.stopped;
      stopped_ = true;
      p_command_ = p_cmd, p_tool_ = t.X_SE.p;
    }
    slave_mode_ = t.mode;
    if (!stopped_) return;
    seen_.resumed += t.mode == Mode::engaged || t.coupled;
    seen_.command_path = std::max(seen_.command_path, (p_cmd - p_command_).norm());
    seen_.tool_path = std::max(seen_.tool_path, (t.X_SE.p - p_tool_).norm());
  }

  Loopback loop_;
  Checkers checkers_;
  Cutter cutter_;
  Seen seen_;
  std::uint64_t cycle_ = 0;
  bool cut_ = false, cut_done_ = false;     // now; begun in this cycle
  bool pressed_ = false, stopped_ = false;  // the robot, for the cut
  Mode master_mode_ = Mode::disconnected, slave_mode_ = Mode::disconnected;
  Vec3 p_command_ = Vec3::Zero(), p_tool_ = Vec3::Zero();
};

TEST(LinkCut, HoldsWithinTheLimitAndMovesOnlyAfterAFreshPress) {
  // Each coupling begins where the last one ended: after some cycles the arm would be at its
  // limits.
  constexpr std::uint64_t kCycles = 20, kRound = kCycles * kNetworks.size();
  const std::uint64_t rounds = (stress_ticks(300) + kRound - 1) / kRound;
  for (const Network& n : kNetworks) {
    Seen s;
    for (std::uint64_t seed = 1; seed <= rounds; ++seed) s.add(Cuts(n, seed, kCycles).run());
    std::printf(
        "%s, %g ms each way: %lu cuts made %lu sides deaf, %lu held, at most %.3f ms after the "
        "last message; %lu times the robot stopped, its command within %.3g mm, the tool within "
        "%.2f mm; engaged %lu times, %lu ticks by an old press\n",
        n.scene, n.delay_ms, s.cuts, s.deaf, s.held, seconds(s.latest) * 1e3, s.stopped,
        s.command_path * 1e3, s.tool_path * 1e3, s.engaged, s.resumed);
    EXPECT_EQ(s.cuts, rounds * kCycles);
    EXPECT_EQ(s.held, s.deaf);
    EXPECT_EQ(s.stopped, s.cuts);
    EXPECT_LE(s.latest, milliseconds(n.stale_ms) + kTick);
    EXPECT_EQ(s.command_path, 0);
    EXPECT_EQ(s.resumed, 0u);
    EXPECT_EQ(s.engaged, s.cuts);
  }
}

}  // namespace
}  // namespace farhand
