#include "common/atan2.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <cstdio>
#include <limits>
#include <numbers>

#include "common/random.hpp"

namespace farhand {
namespace {

double one(double y, double x) {
  double angle = 0;
  atan2<1>(&y, &x, &angle);
  return angle;
}

// Units in the last place of the true angle.
double error(double y, double x) {
  const long double exact = std::atan2(static_cast<long double>(y), static_cast<long double>(x));
  const double size = std::abs(static_cast<double>(exact));
  return static_cast<double>(std::abs(one(y, x) - exact)) / (std::nextafter(size, 4) - size);
}

TEST(Atan2, IsWithinRoundingOfTheTrueAngle) {
  constexpr std::uint64_t kSeed = 6;
  Random random(kSeed);
  double worst = 0;
  for (int k = 0; k < 300000; ++k) {
    const double turn = std::numbers::pi * (2 * random.uniform() - 1);
    const double stretch = std::pow(10, 16 * random.uniform() - 8);  // along and near the axes too
    worst = std::max(worst, error(std::sin(turn), std::cos(turn)));
    worst = std::max(worst, error(stretch * std::sin(turn), std::cos(turn)));
  }
  std::printf("atan2: worst error %.2f units in the last place\n", worst);
  EXPECT_LE(worst, 1.6) << "seed " << kSeed;
}

TEST(Atan2, SeveralAnglesAreTheSameBitsAsOne) {
  const double y[5] = {1, -2, 0.1, -0.3, 5}, x[5] = {-1, 3, 7, -0.01, 1e-9};
  double angle[6] = {0, 0, 0, 0, 0, 42};
  atan2<5>(y, x, angle);
  for (std::size_t i = 0; i < 5; ++i) EXPECT_EQ(angle[i], one(y[i], x[i])) << i;
  EXPECT_EQ(angle[5], 42);
}

TEST(Atan2, AxesAndDiagonalsAreExact) {
  constexpr double kPi = std::numbers::pi;
  for (const double size : {1e-300, 1.0, 1e300}) {
    EXPECT_EQ(one(0, size), 0);
    EXPECT_EQ(one(size, size), kPi / 4);
    EXPECT_EQ(one(size, 0), kPi / 2);
    EXPECT_EQ(one(-size, -size), -3 * kPi / 4);
    EXPECT_EQ(one(-size, 0), -kPi / 2);
  }
}

TEST(Atan2, HalfATurnIsPlusPiFromBothSides) {
  for (const double y : {0.0, -0.0, 1e-300, -1e-300}) EXPECT_EQ(one(y, -1), std::numbers::pi) << y;
}

TEST(Atan2, NoDirectionIsZeroAndNanStaysNan) {
  for (const double y : {0.0, -0.0})
    for (const double x : {0.0, -0.0}) EXPECT_EQ(one(y, x), 0);
  EXPECT_TRUE(std::isnan(one(NAN, 1)));
  EXPECT_TRUE(std::isnan(one(1, NAN)));
}

}  // namespace
}  // namespace farhand
