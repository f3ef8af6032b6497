#include "common/concealment.hpp"

#include <gtest/gtest.h>

#include <cstdio>
#include <vector>

#include "tests/support/human_motion.hpp"

namespace farhand {
namespace {

using std::chrono::milliseconds;

TEST(Concealment, GoesOnThenSlowsThenRests) {
  const ConcealmentConfig c;
  EXPECT_EQ(path(c, milliseconds(0)), 0);
  EXPECT_EQ(path(c, milliseconds(30)), 0.03);
  EXPECT_EQ(pace(c, milliseconds(50)), 1);
  EXPECT_NEAR(pace(c, milliseconds(75)), 0.5, 1e-15);
  EXPECT_NEAR(path(c, milliseconds(75)), 0.05 + 0.025 * 0.75, 1e-15);
  EXPECT_EQ(pace(c, milliseconds(100)), 0);
  EXPECT_NEAR(path(c, milliseconds(100)), 0.075, 1e-15);
  EXPECT_EQ(path(c, milliseconds(100)), path(c, Duration::max()));
  EXPECT_EQ(pace(c, Duration::max()), 0);
}

TEST(Concealment, PaceIsTheRateOfThePath) {
  const ConcealmentConfig c{.full = milliseconds(20), .fade = milliseconds(60)};
  for (int us = 0; us < 120000; us += 500) {
    const Duration a = std::chrono::microseconds(us), b = a + std::chrono::microseconds(500);
    const double rate = (path(c, b) - path(c, a)) / 0.0005;
    EXPECT_NEAR(rate, (pace(c, a) + pace(c, b)) / 2, 1e-12) << us;
  }
}

// Error at the end of a gap, RMS over every moment of two minutes, of a velocity as the master
// sends it.
struct GapError {
  double hold = 0, concealed = 0;  // [m]
};
GapError gap_error(Duration gap, std::uint64_t seed) {
  constexpr double kTs = 0.001;
  HumanMotion motion({}, seed);
  std::vector<double> x{motion.step(kTs)}, v{0};
  const double gain = low_pass_gain(60, kTs);
  while (x.size() < 120000) {
    const double next = motion.step(kTs);
    v.push_back(v.back() + gain * ((next - x.back()) / kTs - v.back()));
    x.push_back(next);
  }
  GapError e;
  const auto n = static_cast<std::size_t>(std::lround(seconds(gap) / kTs));
  for (std::size_t i = 0; i + n < x.size(); ++i) {
    const double moved = x[i + n] - x[i], left = moved - path({}, gap) * v[i];
    e.hold += moved * moved, e.concealed += left * left;
  }
  const double count = static_cast<double>(x.size() - n);
  return {std::sqrt(e.hold / count), std::sqrt(e.concealed / count)};
}

TEST(Concealment, AGapOf20MsCostsAnEighthOfHolding) {
  for (std::uint64_t seed = 1; seed <= 5; ++seed) {
    const GapError e = gap_error(milliseconds(20), seed);
    EXPECT_LE(e.concealed, 0.12 * e.hold) << "seed " << seed;
    std::printf("20 ms: held %.2f mm, concealed %.2f mm, %.3f\n", 1e3 * e.hold, 1e3 * e.concealed,
                e.concealed / e.hold);
  }
}

TEST(Concealment, IsNeverWorseThanHolding) {
  for (const int ms : {1, 5, 10, 50, 100, 200, 400}) {
    const GapError e = gap_error(milliseconds(ms), 1);
    EXPECT_LT(e.concealed, e.hold) << ms;
    std::printf("%d ms: held %.2f mm, concealed %.2f mm\n", ms, 1e3 * e.hold, 1e3 * e.concealed);
  }
}

}  // namespace
}  // namespace farhand
