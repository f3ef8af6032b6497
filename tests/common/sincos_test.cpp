#include "common/sincos.hpp"

#include <gtest/gtest.h>

#include <cstdio>
#include <limits>

#include "common/random.hpp"

namespace farhand {
namespace {

TEST(SinCos, IsWithinRoundingOfTheTrueValues) {
  constexpr std::uint64_t kSeed = 5;
  Random random(kSeed);
  double worst = 0;
  for (const double range : {1e-8, 0.8, 3.2, 100.0, 1e6}) {
    for (int k = 0; k < 20000; ++k) {
      const double x[2] = {range * (2 * random.uniform() - 1), k * 0x1.921fb54442d18p+0};
      const SinCos<2> y = sincos<2>(x);
      for (std::size_t i = 0; i < 2; ++i) {
        const long double exact = x[i];
        worst = std::max(worst, static_cast<double>(std::abs(y.s[i] - std::sin(exact))));
        worst = std::max(worst, static_cast<double>(std::abs(y.c[i] - std::cos(exact))));
      }
    }
  }
  std::printf("sincos: worst error %.3g\n", worst);
  EXPECT_LE(worst, 1e-16) << "seed " << kSeed;
}

TEST(SinCos, ZeroIsExact) {
  const double x[1] = {0};
  EXPECT_EQ(sincos<1>(x).s[0], 0);
  EXPECT_EQ(sincos<1>(x).c[0], 1);
}

TEST(SinCos, HugeAnglesFallBackAndNonFiniteOnesGiveNan) {
  const double x[4] = {1e300, 0.5, NAN, std::numeric_limits<double>::infinity()};
  const SinCos<4> y = sincos<4>(x);
  EXPECT_EQ(y.s[0], std::sin(1e300));
  EXPECT_EQ(y.c[1], std::cos(0.5));
  EXPECT_TRUE(std::isnan(y.s[2]) && std::isnan(y.c[3]));
}

}  // namespace
}  // namespace farhand
