// P+d in whole loops: the twin delta and the arm, over networks of any delay.
#include <gtest/gtest.h>

#include "tests/loop/checkers.hpp"
#include "tests/loop/loopback.hpp"
#include "tests/support/scene_edits.hpp"

namespace farhand {
namespace {

constexpr double kSpring = 400;  // [N/m] of the scene

Scene over(double rtt_ms, double wall) {
  Scene scene = shipped("twin_delta_far");
  proto::Link& link = *scene.proto.mutable_link();
  link.set_stale_ms(300);
  for (proto::Impairment* way : {link.mutable_to_slave(), link.mutable_to_master()}) {
    way->Clear();
    way->set_delay_ms(rtt_ms / 2);
  }
  auto& surface = *scene.proto.mutable_slave()->mutable_sim_arm()->mutable_surface(0);
  surface.set_stiffness_newton_per_m(wall);
  proto::Operator& o = hand(scene);
  o.clear_press();
  press(o, proto::Press::DEAD_MAN, 1, 100);
  o.mutable_motion()->Clear();
  reach(*o.mutable_motion(), 2, 1.5, Vec3(-0.06, 0, 0));  // pressed and held
  return scene;
}

struct Held {
  double stiffness = 0;  // [N/m] felt: of the force by how far the handle is behind the wall
  double chatter = 0;    // [m/s] rms of the handle, while held
  std::uint64_t violations = 0;
};

Held hold(const Scene& scene, double seconds_held) {
  Loopback loop(scene, {.duration_s = 4 + seconds_held});
  Checkers checkers(loop);
  Held out;
  double speed2 = 0, force = 0, depth = 0;
  long n = 0;
  std::optional<double> free;  // where the handle is when the tool touches
  loop.on_slave = [&](const SlaveTick& t) { checkers.check(t); };
  loop.on_master = [&](const MasterTick& t) {
    checkers.check(t);
    const double at = seconds(t.now - loop.start());
    if (!free && at > 1.5) free = t.handle.X_MH.p.x();
    if (at < 3 + seconds_held) return;
    speed2 += t.out.V_MH.linear.squaredNorm();
    force += t.F_G.force.norm();
    depth += *free - 0.03 - t.handle.X_MH.p.x();
    ++n;
  };
  loop.run();
  out.stiffness = force / depth;
  out.chatter = std::sqrt(speed2 / static_cast<double>(n));
  out.violations = checkers.count();
  return out;
}

TEST(DampedLoop, FeelsTheWallInSeriesWithTheSpringAtAnyDelay) {
  for (const double rtt : {2., 20., 100., 200., 400.})
    for (const double wall : {200., 500., 1000.}) {
      const Held h = hold(over(rtt, wall), 6);
      const double expected = wall * kSpring / (wall + kSpring);
      std::printf("%3.0f ms, wall %4.0f N/m: felt %.1f N/m, in series %.1f; handle %.2f mm/s rms\n",
                  rtt, wall, h.stiffness, expected, h.chatter * 1e3);
      EXPECT_EQ(h.violations, 0u);
      EXPECT_NEAR(h.stiffness / expected, 1, 0.02) << rtt << ' ' << wall;
      EXPECT_LT(h.chatter, 0.005) << rtt << ' ' << wall;
    }
}

// Jitter, bursts of loss, duplicates, reordering; gaps beyond stale_ms hold by rule.
TEST(DampedLoop, HoldsTheWallThroughABadNetwork) {
  for (const double rtt : {20., 100., 400.})
    for (std::uint64_t seed = 1; seed <= 3; ++seed) {
      Scene scene = over(rtt, 1000);
      proto::Link& link = *scene.proto.mutable_link();
      link.set_stale_ms(500);
      for (proto::Impairment* way : {link.mutable_to_slave(), link.mutable_to_master()}) {
        way->set_jitter_ms(rtt / 20);
        way->set_burst_enter_ratio(0.002);
        way->set_duplicate_ratio(0.01);
        way->set_corrupt_ratio(0.001);
      }
      scene.proto.set_seed(seed);
      const Held h = hold(scene, 4);
      std::printf("%3.0f ms, seed %lu: felt %.1f N/m, handle %.2f mm/s rms\n", rtt, seed,
                  h.stiffness, h.chatter * 1e3);
      EXPECT_EQ(h.violations, 0u);
      EXPECT_NEAR(h.stiffness / 285.7, 1, 0.02) << rtt << ' ' << seed;
      EXPECT_LT(h.chatter, 0.005) << rtt << ' ' << seed;
    }
}

}  // namespace
}  // namespace farhand
