#include "common/histogram.hpp"

#include <gtest/gtest.h>

namespace farhand {
namespace {

TEST(Histogram, QuantilesOfAUniformRampAreWithinOneBucket) {
  Histogram h;
  for (int i = 1; i <= 100000; ++i) h.add(Duration(i * 10));
  for (double p : {0.01, 0.1, 0.5, 0.9, 0.99})
    EXPECT_NEAR(static_cast<double>(h.quantile(p).count()), p * 1e6, p * 1e6 / 31) << p;
  EXPECT_EQ(h.max(), Duration(1000000));
  EXPECT_EQ(h.quantile(1), Duration(1000000));
}

TEST(Histogram, EdgesDoNotEscape) {
  Histogram h;
  EXPECT_EQ(h.quantile(0.5), Duration(0));
  h.add(Duration(-5));
  h.add(Duration::max());
  EXPECT_EQ(h.count(), 2u);
  EXPECT_EQ(h.quantile(0.1), Duration(0));
  EXPECT_EQ(h.max(), Duration::max());
}

}  // namespace
}  // namespace farhand
