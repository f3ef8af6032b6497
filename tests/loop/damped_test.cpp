// P+d in whole loops: the twin delta and the arm, over networks of any delay.
#include "tests/loop/pressing.hpp"

namespace farhand {
namespace {

constexpr double kSpring = 400;  // [N/m] of the scene

// At 400 ms the hand waits before it presses: after free motion there the guard has spent its store
// and takes part of the force away.

TEST(DampedLoop, FeelsTheWallInSeriesWithTheSpringAtAnyDelay) {
  for (const double rtt : {2., 20., 100., 200., 400.})
    for (const double wall : {200., 500., 1000.}) {
      const Pressing h = pressed(pressing_over(rtt, wall, rtt < 400), 6);
      const double expected = wall * kSpring / (wall + kSpring);
      std::printf("%3.0f ms, wall %4.0f N/m: felt %.1f N/m, in series %.1f; handle %.2f mm/s rms\n",
                  rtt, wall, h.stiffness, expected, h.chatter * 1e3);
      EXPECT_EQ(h.violations, 0u);
      EXPECT_NEAR(h.stiffness / expected, 1, 0.02) << rtt << ' ' << wall;
      EXPECT_LT(h.chatter, 0.005) << rtt << ' ' << wall;
    }
}

TEST(DampedLoop, HoldsTheWallThroughABadNetwork) {
  for (const double rtt : {20., 100., 400.})
    for (std::uint64_t seed = 1; seed <= 3; ++seed) {
      Scene scene = pressing_over(rtt, 1000, rtt < 400);
      worsen(scene, rtt / 20);
      scene.proto.set_seed(seed);
      const Pressing h = pressed(scene, 4);
      std::printf("%3.0f ms, seed %lu: felt %.1f N/m, handle %.2f mm/s rms\n", rtt, seed,
                  h.stiffness, h.chatter * 1e3);
      EXPECT_EQ(h.violations, 0u);
      EXPECT_NEAR(h.stiffness / 285.7, 1, 0.02) << rtt << ' ' << seed;
      EXPECT_LT(h.chatter, 0.005) << rtt << ' ' << seed;
    }
}

}  // namespace
}  // namespace farhand
