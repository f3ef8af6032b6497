// P+d in whole loops: the twin delta and the arm, over networks of any delay.
#include <gtest/gtest.h>

#include "tests/loop/pressing.hpp"

namespace farhand {
namespace {

constexpr double kSpring = 400;  // [N/m] of the scene

TEST(DampedLoop, FeelsTheWallInSeriesWithTheSpringAtAnyDelay) {
  for (const double rtt : {2., 20., 100., 200., 400.})
    for (const double wall : {200., 500., 1000.}) {
      const Pressing h = pressed(pressing_over(rtt, wall), 6);
      const double expected = wall * kSpring / (wall + kSpring);
      std::printf("%3.0f ms, wall %4.0f N/m: felt %.1f N/m, in series %.1f; handle %.2f mm/s rms\n",
                  rtt, wall, h.stiffness, expected, h.chatter * 1e3);
      EXPECT_EQ(h.violations, 0u);
      EXPECT_NEAR(h.stiffness / expected, 1, 0.02) << rtt << ' ' << wall;
      EXPECT_LT(h.chatter, 0.005) << rtt << ' ' << wall;
    }
}

// Coupled in contact alone, with a spring that is stiffer than a device could damp in free motion:
// what knows nothing of the world feels best so.
TEST(DampedLoop, FeelsMoreOfTheWallWhereItIsCoupledInContactAlone) {
  constexpr double kStiffer = 1500;
  for (const double rtt : {2., 20., 100., 200.})
    for (const double wall : {200., 1000., 5000.}) {
      Scene scene = pressing_over(rtt, wall);
      proto::DampedCompensation& damped = *scene.proto.mutable_compensation()->mutable_damped();
      damped.set_stiffness_newton_per_m(kStiffer);
      damped.set_max_damping_newton_s_per_m(400);
      damped.mutable_touch();
      const Pressing h = pressed(scene, 6);
      const double expected = wall * kStiffer / (wall + kStiffer);
      std::printf(
          "%3.0f ms, wall %4.0f N/m: felt %.3f of it, in series %.3f; drag %.2f N, handle "
          "%.2f mm/s rms\n",
          rtt, wall, h.stiffness / wall, expected / wall, h.drag, h.chatter * 1e3);
      EXPECT_EQ(h.violations, 0u);
      EXPECT_LT(h.chatter, 0.003) << rtt << ' ' << wall;
      EXPECT_LT(h.drag, 1.6) << rtt << ' ' << wall;
      if (wall < 5000) {
        EXPECT_NEAR(h.stiffness / expected, 1, 0.03) << rtt << ' ' << wall;
      }
    }
}

TEST(DampedLoop, HoldsTheWallThroughABadNetwork) {
  for (const double rtt : {20., 100., 400.})
    for (std::uint64_t seed = 1; seed <= 3; ++seed) {
      Scene scene = pressing_over(rtt, 1000);
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
