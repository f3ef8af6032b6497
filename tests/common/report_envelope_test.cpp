#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <limits>

#include "common/random.hpp"
#include "common/report/envelope.hpp"

namespace farhand {
namespace {

constexpr float kNaN = std::numeric_limits<float>::quiet_NaN();

struct Signal {
  std::vector<double> t;
  std::vector<float> y;
};

Signal noise(std::uint64_t seed, std::size_t count) {
  Random random(seed);
  Signal s;
  for (std::size_t i = 0; i < count; ++i) {
    s.t.push_back(static_cast<double>(i) * 1e-3);
    s.y.push_back(static_cast<float>(random.normal()));
  }
  return s;
}

TEST(Envelope, EveryGlobalExtremeSurvives) {
  for (std::uint64_t seed = 1; seed <= 50; ++seed) {
    Signal s = noise(seed, 20000);
    s.y[(seed * 7919) % s.y.size()] = 40;  // a peak one sample wide
    s.y[(seed * 104729) % s.y.size()] = -50;
    const auto points = envelope(s.t, s.y, 0, s.t.back(), 300);
    EXPECT_LE(points.size(), 600u) << "seed " << seed;
    const auto [lo, hi] = std::minmax_element(
        points.begin(), points.end(), [](const Point& a, const Point& b) { return a.y < b.y; });
    EXPECT_EQ(lo->y, -50) << "seed " << seed;
    EXPECT_EQ(hi->y, 40) << "seed " << seed;
    EXPECT_EQ(s.y[static_cast<std::size_t>(std::lround(hi->x * 1e3))], 40) << "seed " << seed;
  }
}

TEST(Envelope, EveryColumnKeepsItsOwnExtremes) {
  const Signal s = noise(3, 10000);
  const double end = 10;
  const auto points = envelope(s.t, s.y, 0, end, 100);
  for (int c = 0; c < 100; ++c) {
    float lo = 1e9f, hi = -1e9f;
    double kept_lo = 1e9, kept_hi = -1e9;
    const auto inside = [&](double t) { return t >= 10.0 * c / 100 && t < 10.0 * (c + 1) / 100; };
    for (std::size_t i = 0; i < s.y.size(); ++i)
      if (inside(s.t[i])) lo = std::min(lo, s.y[i]), hi = std::max(hi, s.y[i]);
    for (const Point& p : points)
      if (inside(p.x)) kept_lo = std::min(kept_lo, p.y), kept_hi = std::max(kept_hi, p.y);
    EXPECT_EQ(kept_lo, lo) << "column " << c;
    EXPECT_EQ(kept_hi, hi) << "column " << c;
  }
}

TEST(Envelope, TimeNeverRunsBackwards) {
  const Signal s = noise(4, 30000);
  const auto points = envelope(s.t, s.y, 0, s.t.back(), 500);
  EXPECT_TRUE(std::is_sorted(points.begin(), points.end(),
                             [](const Point& a, const Point& b) { return a.x < b.x; }));
}

TEST(Envelope, ShortSignalsAreKeptWhole) {
  const Signal s = noise(5, 200);
  const auto points = envelope(s.t, s.y, 0, s.t.back(), 100, 2.0);
  ASSERT_EQ(points.size(), 200u);
  for (std::size_t i = 0; i < 200; ++i) EXPECT_EQ(points[i].y, s.y[i] * 2.0);
}

TEST(Envelope, AGapInterruptsTheLineOnce) {
  Signal s = noise(6, 10000);
  std::fill(s.y.begin() + 3000, s.y.begin() + 6000, kNaN);
  const auto points = envelope(s.t, s.y, 0, s.t.back(), 100);
  EXPECT_EQ(
      std::count_if(points.begin(), points.end(), [](const Point& p) { return std::isnan(p.y); }),
      1);
}

TEST(Envelope, NothingIsDrawnOfNothing) {
  EXPECT_TRUE(envelope({}, {}, 0, 1, 100).empty());
  const Signal s = noise(7, 10);
  EXPECT_TRUE(envelope(s.t, s.y, 5, 6, 100).empty());
}

struct Path {
  std::vector<float> x, y;
};
Path circles(int count) {
  Path p;
  for (int i = 0; i < 6284 * count; ++i) {
    p.x.push_back(static_cast<float>(std::cos(i * 1e-3)));
    p.y.push_back(static_cast<float>(std::sin(i * 1e-3)));
  }
  return p;
}

TEST(ThinPath, EverySampleIsWithinACellOfOneThatIsDrawn) {
  const Path p = circles(1);
  const auto points = thin_path(p.x, p.y, 100);
  constexpr double kCell = 2.0 / 100;
  for (std::size_t i = 0; i < p.x.size(); i += 7) {
    double nearest = 1e9;
    for (const Point& q : points)
      nearest = std::min(nearest, std::max(std::abs(q.x - p.x[i]), std::abs(q.y - p.y[i])));
    EXPECT_LE(nearest, kCell) << i;
  }
}

TEST(ThinPath, ARepeatedMotionIsAsLongAsOne) {
  const Path once = circles(1), often = circles(40);
  const std::size_t one = thin_path(once.x, once.y, 100).size();
  EXPECT_LT(one, 2000u);
  EXPECT_LT(thin_path(often.x, often.y, 100).size(), 2 * one);
}

TEST(ThinPath, ASlowMotionIsOneUnbrokenLine) {
  const Path p = circles(1);
  for (const Point& q : thin_path(p.x, p.y, 100)) EXPECT_FALSE(std::isnan(q.y)) << q.x;
}

TEST(ThinPath, ExtremesSurviveAndMissingSamplesInterrupt) {
  Path p = circles(3);
  p.x[9000] = 3;  // one far sample
  p.y[9500] = kNaN;
  const auto points = thin_path(p.x, p.y, 100);
  EXPECT_EQ(std::max_element(points.begin(), points.end(),
                             [](const Point& a, const Point& b) { return a.x < b.x; })
                ->x,
            3);
  for (const Point& q : points) EXPECT_FALSE(std::isnan(q.x));
  EXPECT_TRUE(thin_path({}, {}, 100).empty());
}

}  // namespace
}  // namespace farhand
