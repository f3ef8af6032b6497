#include "common/playout.hpp"

#include <gtest/gtest.h>

#include <cstdio>
#include <map>

#include "common/random.hpp"

namespace farhand {
namespace {

using std::chrono::milliseconds;

TEST(RecentMinimum, ForgetsWhatIsOlderThanTheWindow) {
  RecentMinimum m(milliseconds(800));
  EXPECT_TRUE(m.empty());
  m.add(milliseconds(50), milliseconds(3));
  for (int t = 100; t < 800; t += 10) m.add(milliseconds(t), milliseconds(7));
  EXPECT_EQ(m.minimum(), milliseconds(3));
  m.add(milliseconds(910), milliseconds(8));
  EXPECT_EQ(m.minimum(), milliseconds(7));
  m.add(milliseconds(99999), milliseconds(9));
  EXPECT_EQ(m.minimum(), milliseconds(9));
}

TEST(RecentHistogram, TellsWithinWhatAllButAShareLieAndForgets) {
  RecentHistogram h(milliseconds(800));
  EXPECT_TRUE(h.empty());
  for (int t = 1000; t < 1100; ++t) h.add(milliseconds(t), t < 1005 ? 40 : 7);
  EXPECT_EQ(h.most(0), 41u);
  EXPECT_EQ(h.most(0.04), 41u);
  EXPECT_EQ(h.most(0.05), 8u);
  h.lower(30);
  EXPECT_EQ(h.most(0), 11u);
  EXPECT_EQ(h.most(0.05), 1u);
  h.add(milliseconds(1100), 100000);
  EXPECT_EQ(h.most(0), RecentHistogram::kBins);
  for (int t = 1101; t < 2000; ++t) h.add(milliseconds(t), 3);
  EXPECT_EQ(h.most(0), 4u);
  h.add(milliseconds(99999), 5);
  EXPECT_EQ(h.most(0), 6u);
}

// The sender's clock is 1 h ahead. A value says when it was sent, so what comes out says how old
// it is.
constexpr Duration kAhead = std::chrono::hours(1);

struct Played {
  double delay = 0, most_change = 0;  // [s] of the age at the end; per tick after 5 s
  bool backwards = false;
};

// 1 kHz for 20 s; transit(t [s]) [s] per message.
template <typename Transit>
Played play(Playout<double>& p, Transit&& transit, bool twice = false) {
  std::multimap<Duration, Duration> way;
  Played out;
  double last = 0, last_age = 0;
  for (int i = 0; i < 20000; ++i) {
    const Duration now = milliseconds(i);
    const double T = transit(1e-3 * i);
    if (T >= 0) way.emplace(now + from_seconds(T), now);
    if (T >= 0 && twice) way.emplace(now + from_seconds(1.3 * T + 0.002), now);
    for (; !way.empty() && way.begin()->first <= now; way.erase(way.begin())) {
      const Duration sent = way.begin()->second;
      p.push(sent + kAhead, seconds(sent), now);
    }
    const double value = p.play(now), age = seconds(now) - value;
    out.backwards = out.backwards || value < last;
    if (i > 5000) out.most_change = std::max(out.most_change, std::abs(age - last_age));
    last = value, last_age = age;
  }
  out.delay = last_age;
  return out;
}

double gamma2(Random& r, double mean) {
  return -mean / 2 * std::log((1 - r.uniform()) * (1 - r.uniform()));
}

TEST(Playout, EvensOutJitterInOrderAtTheCostOfItsQuantile) {
  for (const double jitter : {0.001, 0.005, 0.010}) {
    // So far apart that none overtakes another: every 40th ms a message.
    Random r(7);
    Playout<double> p({.late_share = 0.01, .memory = 20});
    const Played x = play(p, [&, n = 0](double) mutable {
      return n++ % 40 == 0 ? 0.020 + std::min(gamma2(r, jitter), 0.039) : -1;
    });
    std::printf("jitter %.0f ms: played %.1f ms after the fastest\n", 1e3 * jitter,
                1e3 * p.delay());
    EXPECT_FALSE(x.backwards);
    // 99 % of a gamma distribution of shape 2 lie below 3.32 means; 500 samples, bins of 1 ms.
    EXPECT_NEAR(p.delay(), std::min(3.32 * jitter, 0.039), 0.5 * jitter + 0.0015);
  }
}

TEST(Playout, NeedsLessWhereMessagesOvertake) {
  for (const double jitter : {0.001, 0.005, 0.010}) {
    Random r(7);
    Playout<double> p({.late_share = 0.01});
    const Played x = play(p, [&](double) { return 0.020 + gamma2(r, jitter); });
    std::printf(
        "jitter %.0f ms, 1 kHz: played %.1f ms after the fastest, held back %.2f ms at "
        "most in a tick\n",
        1e3 * jitter, 1e3 * p.delay(), 1e3 * x.most_change);
    EXPECT_FALSE(x.backwards);
    EXPECT_LE(p.delay(), 1.2 * jitter + 0.002);
    EXPECT_NEAR(x.delay, 0.020 + p.delay(), 0.002);
  }
}

TEST(Playout, InterpolatesBetweenMessagesAndHoldsAfterTheNewest) {
  Playout<double> p({});
  for (int i = 0; i <= 5; ++i) p.push(milliseconds(i), i, milliseconds(i + 10));
  for (int i = 15; i < 29; ++i) p.play(milliseconds(i));
  EXPECT_NEAR(p.delay(), 0.001, 1e-12);
  EXPECT_EQ(p.play(milliseconds(29)), 5);
  p.push(milliseconds(20), 20, milliseconds(30));
  EXPECT_NEAR(p.play(milliseconds(30)), 19, 1e-9);
  p.push(milliseconds(18), -100, milliseconds(31));  // overtaken
  EXPECT_NEAR(p.play(milliseconds(31)), 20, 1e-9);
}

TEST(Playout, TellsWhatItGivesOutAndSkipsWhatIsNotWantedAnyMore) {
  Playout<double> p({});
  EXPECT_EQ(p.newest(-1), -1);
  for (int i = 0; i <= 5; ++i) p.push(milliseconds(i), i, milliseconds(i + 10));
  EXPECT_EQ(p.newest(), 5);
  EXPECT_EQ(p.play(milliseconds(13)), 2);
  EXPECT_EQ(p.given(), milliseconds(2));
  p.play(milliseconds(50));
  EXPECT_EQ(p.given(), milliseconds(5));  // held: no more of it was given
  for (int i = 50; i <= 55; ++i) p.push(milliseconds(i), i, milliseconds(i + 10));
  p.skip_to_newest();
  EXPECT_EQ(p.play(milliseconds(60)), 55);
  EXPECT_EQ(p.given(), milliseconds(55));
}

TEST(Playout, StretchesTimeWhenTheWayGetsLongerAndShrinksIt) {
  Playout<double> p({});
  double middle = 0;
  const Played x = play(p, [&](double t) {
    if (t < 12) middle = p.delay();
    return t > 6 && t < 12 ? 0.060 : 0.020;
  });
  EXPECT_GE(middle, 0.0);
  EXPECT_NEAR(x.delay, 0.020 + p.delay(), 0.002);
  EXPECT_FALSE(x.backwards);
}

TEST(Playout, HoldsInAGapAndForgetsNoOrder) {
  Playout<double> p({});
  const Played x = play(
      p, [&](double t) { return t > 10 && t < 11 ? -1 : 0.010; }, true);
  EXPECT_FALSE(x.backwards);
  EXPECT_NEAR(x.delay, 0.010 + p.delay(), 0.002);
  Playout<double> none({});
  EXPECT_EQ(none.play(milliseconds(5), 7.0), 7.0);
}

// By the sender's or the receiver's clock, or by a way that got so much longer or shorter.
TEST(Playout, ALeastTransitThatChangesIsNoJitter) {
  for (const double by : {0.25, -0.25}) {
    Playout<double> p({});
    double settled = 0;
    const Played x = play(p, [&](double t) {
      if (t < 17) settled = p.delay();
      return t > 10 ? 0.300 + by : 0.300;
    });
    std::printf("%+.0f ms: played %.1f ms after the fastest 7 s later\n", 1e3 * by, 1e3 * settled);
    EXPECT_FALSE(x.backwards);
    EXPECT_LT(settled, 0.003);
  }
}

// 2.2 s after a network that stopped for 150 ms again and again; by squeezing time it takes seconds
// more.
TEST(Playout, AUseBeginsWithTheDelayThatIsRightThen) {
  for (const bool begins : {false, true}) {
    Playout<double> p({});
    double played = 0;
    Duration now{};
    const auto push = [&](Duration sent) { p.push(sent + kAhead, seconds(sent), now); };
    for (int i = 1; i <= 7200; ++i) {
      now = milliseconds(i);
      if (i > 5000) push(now);
      if (i <= 5000 && i % 150 == 0)
        for (int k = i - 149; k <= i; ++k) push(milliseconds(k));
      if (begins && i == 7190) p.settle();
      const double value = p.play(now);
      EXPECT_GE(value, played) << i;
      played = value;
    }
    const double age = seconds(now) - played;
    if (begins)
      EXPECT_LT(age, 0.005);
    else
      EXPECT_GT(age, 0.02);
  }
}

}  // namespace
}  // namespace farhand
