// The hand presses the tool into a wall, and something comes between: the clutch, a cut of the
// network, another process on either side. Nothing may move the robot or jump at the hand before a
// fresh press, nor after it.
#include <gtest/gtest.h>

#include "tests/loop/pressing.hpp"
#include "tests/support/allocations.hpp"

namespace farhand {
namespace {

using Choose = void (*)(Scene&);

void choose_direct(Scene& scene) {
  scene.proto.mutable_compensation()->mutable_direct();
}
void choose_wave(Scene& scene) {
  scene.proto.mutable_compensation()->mutable_wave();
}
void choose_smith(Scene& scene) {
  const proto::Surface& surface = scene.proto.slave().sim_arm().surface(0);
  proto::RegisteredWall& w = *scene.proto.mutable_compensation()->mutable_smith()->mutable_wall();
  *w.mutable_point_in_slave_m() = surface.plane().point_m();
  for (const double n : surface.plane().normal()) w.add_normal_in_slave(-n);
  w.set_stiffness_newton_per_m(surface.stiffness_newton_per_m());
}

struct Case {
  const char* name;
  Choose choose;
  double rtt, wall;
};
constexpr Case kCases[] = {{"direct", choose_direct, 2, 1000},
                           {"wave", choose_wave, 20, 1000},
                           {"wave", choose_wave, 100, 1000},
                           {"smith", choose_smith, 20, 500}};

constexpr double kEvent = 6;    // [s] pressed for two seconds by then
constexpr double kRelease = 7;  // the dead-man is let go of
constexpr double kPress = 8;    // and pressed again
constexpr double kEnd = 11;

// [N] the most in the last half second before the event, and from then on.
struct Peak {
  double before = 0, after = 0;
  void add(double at, double F) {
    if (at >= kEvent) after = std::max(after, F);
    if (at < kEvent && at > kEvent - 0.5) before = std::max(before, F);
  }
};

struct Seen {
  Peak felt, contact;
  double moved = 0;                         // [m] of the target while the robot was uncoupled
  bool uncoupled = false, coupled = false;  // after the event, and at the end
  std::uint64_t violations = 0;
};

Scene interrupted(const Case& c, bool presses_again) {
  Scene scene = pressing_over(c.rtt, c.wall, false);
  scene.proto.mutable_link()->set_stale_ms(200);
  c.choose(scene);
  proto::Operator& o = hand(scene);
  o.clear_press();
  press(o, proto::Press::DEAD_MAN, 1, presses_again ? kRelease - 1 : 100);
  if (presses_again) press(o, proto::Press::DEAD_MAN, kPress, 100);
  return scene;
}

template <typename Event>
Seen run(const Case& c, bool presses_again, Event&& event) {
  Loopback loop(interrupted(c, presses_again), {.duration_s = kEnd});
  Checkers checkers(loop);
  Seen seen;
  std::optional<Vec3> held;  // the target of the last tick, uncoupled
  const auto at = [&] { return seconds(loop.now() - loop.start()); };
  loop.on_slave = [&](const SlaveTick& t) {
    checkers.check(t);
    seen.contact.add(at(), t.F_E_S.force.norm());
    if (!t.coupled && held) seen.moved = std::max(seen.moved, (t.X_SE_target.p - *held).norm());
    held.reset();
    if (!t.coupled && at() > 1) held = t.X_SE_target.p;
    seen.uncoupled = seen.uncoupled || (at() > kEvent && !t.coupled);
    seen.coupled = t.coupled;
  };
  loop.on_master = [&](const MasterTick& t) {
    checkers.check(t);
    seen.felt.add(at(), t.F_G.force.norm());
  };
  loop.run_until(loop.start() + from_seconds(kEvent));
  event(loop, checkers);
  loop.run();
  seen.violations = checkers.count();
  return seen;
}

void expect_calm(const Case& c, const char* what, const Seen& s) {
  std::printf("%-6s %3.0f ms, %s: felt %.2f N before, %.2f N at most after; contact %.2f, %.2f N\n",
              c.name, c.rtt, what, s.felt.before, s.felt.after, s.contact.before, s.contact.after);
  EXPECT_EQ(s.violations, 0u) << c.name << ' ' << what;
  EXPECT_GT(s.felt.before, 1) << c.name << ' ' << what;
  EXPECT_TRUE(s.uncoupled && s.coupled) << c.name << ' ' << what;
  EXPECT_EQ(s.moved, 0) << c.name << ' ' << what;
  EXPECT_LE(s.felt.after, s.felt.before + 1) << c.name << ' ' << what;
  EXPECT_LE(s.contact.after, s.contact.before + 1) << c.name << ' ' << what;
}

TEST(Interrupted, ByTheClutch) {
  for (const Case& c : kCases) {
    expect_calm(c, "clutch", run(c, false, [](Loopback& loop, Checkers&) {
                  loop.on_reading = [&loop](HandleReading& r) {
                    r.clutch = seconds(loop.now() - loop.start()) < kEvent + 0.5;
                  };
                }));
  }
}

TEST(Interrupted, ByACut) {
  for (const Case& c : kCases)
    expect_calm(c, "cut of 300 ms", run(c, true, [](Loopback& loop, Checkers&) {
                  loop.cut(true, true);
                  loop.run_until(loop.now() + std::chrono::milliseconds(300));
                  loop.cut(false, false);
                }));
}

TEST(Interrupted, ByAnotherMaster) {
  for (const Case& c : kCases)
    expect_calm(c, "master restarts", run(c, true, [](Loopback& loop, Checkers& checkers) {
                  loop.restart(Side::master, std::chrono::milliseconds(100), 11);
                  checkers.restarted(Side::master);
                }));
}

TEST(Interrupted, ByAnotherSlave) {
  for (const Case& c : kCases)
    expect_calm(c, "slave restarts", run(c, true, [](Loopback& loop, Checkers& checkers) {
                  loop.restart(Side::slave, std::chrono::milliseconds(100), 12);
                  checkers.restarted(Side::slave);
                }));
}

TEST(Interrupted, TicksTakeNothingFromTheHeap) {
  for (const Case& c : kCases) {
    const Scene scene = interrupted(c, false);
    CompensatedForce force(*master_config(scene.proto).compensated);
    CompensatedTarget target(*slave_config(scene.proto).compensated);
    MasterToSlave down;
    SlaveToMaster up{.has_robot = true};
    const HandlePose handle;
    const Pose X;
    const Twist V;
    const Wrench F{.force = Vec3(1, 0, 0)};
    TimePoint now{std::chrono::seconds(1)};
    const auto tick = [&](std::uint64_t session) {
      now += std::chrono::milliseconds(1);
      const Duration sent = now.time_since_epoch() - std::chrono::milliseconds(3);
      force.hear({.newest = &up, .age = {}, .sent = sent, .session = session}, now);
      target.hear({.newest = &down, .age = {}, .sent = sent, .session = session}, now);
      target.step({X, X, V, F, down, {}, {}, now});
      target.tell(up);
      force.step({handle, V, up, {}, 1, now});
      force.tell(down);
    };
    EXPECT_EQ(allocations_in([&] {
                target.start(X, {}, {});
                for (int i = 0; i < 600; ++i) tick(1);
                force.let_go();
                for (int i = 0; i < 600; ++i) tick(2);
              }),
              0u)
        << c.name;
  }
}

}  // namespace
}  // namespace farhand
