#include "common/random.hpp"

#include <gtest/gtest.h>

namespace farhand {
namespace {

TEST(Random, SameSeedSameSequenceAndOtherSeedsDiffer) {
  Random a(7), b(7), c(8);
  for (int k = 0; k < 100; ++k) {
    const std::uint64_t x = a.bits();
    EXPECT_EQ(x, b.bits());
    EXPECT_NE(x, c.bits());
  }
}

TEST(Random, UniformFillsTheUnitInterval) {
  Random random(1);
  double sum = 0, least = 1, most = 0;
  constexpr int kDraws = 100000;
  for (int k = 0; k < kDraws; ++k) {
    const double u = random.uniform();
    sum += u;
    least = std::min(least, u);
    most = std::max(most, u);
  }
  EXPECT_GE(least, 0);
  EXPECT_LT(most, 1);
  EXPECT_NEAR(sum / kDraws, 0.5, 0.005);
  EXPECT_LT(least, 1e-3);
  EXPECT_GT(most, 1 - 1e-3);
}

TEST(Random, NormalHasTheMomentsOfANormal) {
  Random random(2);
  constexpr int kDraws = 200000;
  double m1 = 0, m2 = 0, m3 = 0, m4 = 0;
  for (int k = 0; k < kDraws; ++k) {
    const double x = random.normal();
    m1 += x, m2 += x * x, m3 += x * x * x, m4 += x * x * x * x;
  }
  EXPECT_NEAR(m1 / kDraws, 0, 0.01);
  EXPECT_NEAR(m2 / kDraws, 1, 0.02);
  EXPECT_NEAR(m3 / kDraws, 0, 0.04);
  EXPECT_NEAR(m4 / kDraws, 3, 0.12);
}

}  // namespace
}  // namespace farhand
