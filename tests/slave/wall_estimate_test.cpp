#include "slave/compensation/wall_estimate.hpp"

#include <gtest/gtest.h>

#include <cmath>

#include "common/random.hpp"

namespace farhand {
namespace {

// A tool that presses 3 mm deep and moves by 1 mm at 2 Hz, force noise of 0.05 N.
void press(WallEstimate& e, double k, double b, double seconds, std::uint64_t seed = 1) {
  Random random(seed);
  for (int i = 0; i < 1000 * seconds; ++i) {
    const double w = 4 * std::acos(-1.0), t = 0.001 * i;
    const double x = 0.003 + 0.001 * std::sin(w * t), v = 0.001 * w * std::cos(w * t);
    e.step(x, v, k * x + b * v + 0.05 * random.normal());
  }
}

TEST(WallEstimate, FindsStiffnessAndDamping) {
  for (const double k : {200., 1000., 5000.})
    for (std::uint64_t seed = 1; seed <= 5; ++seed) {
      WallEstimate e({});
      press(e, k, 5, 8, seed);
      EXPECT_NEAR(e.k(), k, 20 + 0.02 * k) << seed;  // 20 N/m: 0.05 N of noise on 1 mm of motion
      EXPECT_NEAR(e.b(), 5, 3) << seed;
    }
}

TEST(WallEstimate, RisesFastAndFallsSlowly) {
  WallEstimate e({});
  press(e, 5000, 0, 0.5);
  EXPECT_GT(e.k(), 4500);
  press(e, 500, 0, 0.5);
  EXPECT_GT(e.k(), 3500);
  press(e, 500, 0, 8);
  EXPECT_LT(e.k(), 700);
}

TEST(WallEstimate, LearnsNothingFromStandingStill) {
  WallEstimate e({});
  press(e, 2000, 5, 4);
  const double k = e.k();
  for (int i = 0; i < 100000; ++i) e.step(0.005, 0.001 * std::sin(0.3 * i), 2000 * 0.003);
  EXPECT_NEAR(e.k(), k, 0.05 * k);
}

}  // namespace
}  // namespace farhand
