#include <gtest/gtest.h>

#include <cmath>
#include <limits>

#include "common/random.hpp"
#include "common/report/ticks.hpp"

namespace farhand {
namespace {

TEST(LinearTicks, AreOneTwoOrFiveTimesAPowerOfTenApart) {
  Random random(11);
  for (int n = 0; n < 2000; ++n) {
    const double lo = random.normal() * std::pow(10, 4 * random.uniform() - 2);
    const double hi = lo + std::pow(10, 8 * random.uniform() - 4);
    const auto ticks = linear_ticks(lo, hi, 6);
    ASSERT_LE(ticks.size(), 6u) << lo << " " << hi;
    ASSERT_GE(ticks.size(), 2u) << lo << " " << hi;
    const double step = ticks[1].at - ticks[0].at;
    const double digit = step / std::pow(10, std::floor(std::log10(step) + 1e-6));
    const double off = std::min({std::abs(digit - 1), std::abs(digit - 2), std::abs(digit - 5)});
    EXPECT_LT(off, 1e-3) << lo << " " << hi << " step " << step;
    for (const Tick& t : ticks) {
      EXPECT_GE(t.at, lo - 1e-6 * step);
      EXPECT_LE(t.at, hi + 1e-6 * step);
    }
  }
}

TEST(LinearTicks, LabelsOfAnAxisHaveTheSameDecimals) {
  const auto ticks = linear_ticks(-0.5, 1.1, 6);
  ASSERT_EQ(ticks.size(), 4u);
  EXPECT_EQ(ticks[0].label, "\u22120.5");
  EXPECT_EQ(ticks[1].label, "0.0");
  EXPECT_EQ(ticks[3].label, "1.0");
}

TEST(LinearTicks, AnEndOnAMultipleHasItsTick) {
  EXPECT_EQ(linear_ticks(0, 20, 6).back().label, "20");
  EXPECT_EQ(linear_ticks(0, 0.3, 4).back().label, "0.3");
}

TEST(LinearTicks, AnEmptyOrEndlessRangeHasNone) {
  EXPECT_TRUE(linear_ticks(1, 1, 6).empty());
  EXPECT_TRUE(linear_ticks(2, 1, 6).empty());
  EXPECT_TRUE(linear_ticks(0, std::numeric_limits<double>::infinity(), 6).empty());
  EXPECT_TRUE(linear_ticks(std::nan(""), 1, 6).empty());
}

TEST(LogTicks, NameThePowersOfTen) {
  std::string names;
  for (const Tick& t : log_ticks(0.5, 2000, 6)) names += t.label.empty() ? "" : t.label + " ";
  EXPECT_EQ(names, "1 10 100 1000 ");
}

TEST(LogTicks, NameTwoAndFiveWhereThereIsRoom) {
  std::string names;
  for (const Tick& t : log_ticks(0.9, 30, 6)) names += t.label.empty() ? "" : t.label + " ";
  EXPECT_EQ(names, "1 2 5 10 20 ");
}

TEST(LogTicks, ARangeFromZeroHasNone) {
  EXPECT_TRUE(log_ticks(0, 10, 6).empty());
}

}  // namespace
}  // namespace farhand
