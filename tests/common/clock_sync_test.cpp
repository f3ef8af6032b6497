#include "common/clock_sync.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <deque>
#include <functional>

#include "common/random.hpp"

namespace farhand {
namespace {

using namespace std::chrono_literals;

double microseconds(Duration d) {
  return 1e6 * seconds(d);
}

// A peer at 1 kHz whose clock shows ours plus `offset`, and who answers after 0.2 ms.
struct Path {
  Duration offset{}, there{}, back{};
  double jitter = 0;  // mean of each way's gamma jitter [s]
  double drift = 0;   // of the peer's clock
};

Duration gamma_jitter(Random& random, double mean) {
  const double u = 1 - random.uniform(), v = 1 - random.uniform();
  return from_seconds(-0.5 * mean * std::log(u * v));
}

void run(ClockSync& sync, Random& random, const Path& path, Duration from, Duration to) {
  const auto peer_clock = [&](Duration t) {
    return t + path.offset + from_seconds(path.drift * seconds(t));
  };
  for (Duration t1 = from; t1 < to; t1 += 1ms) {
    const Duration arrival = t1 + path.there + gamma_jitter(random, path.jitter);
    const Duration reply = arrival + 200us;
    const Duration t4 = reply + path.back + gamma_jitter(random, path.jitter);
    sync.add({t1, peer_clock(arrival), peer_clock(reply), t4});
  }
}

TEST(ClockSync, AQuietSymmetricPathGivesTheOffsetExactly) {
  ClockSync sync;
  Random random(1);
  EXPECT_FALSE(sync.estimate().valid);
  for (const Duration offset : {Duration(0), Duration(-3h), Duration(123456789)}) {
    sync.clear();
    run(sync, random, {.offset = offset, .there = 7ms, .back = 7ms}, 0s, 10ms);
    const ClockEstimate clock = sync.estimate();
    ASSERT_TRUE(clock.valid);
    EXPECT_EQ(clock.offset, offset);
    EXPECT_EQ(clock.round_trip, 14ms);
    EXPECT_EQ(clock.uncertainty, 7ms);
  }
}

TEST(ClockSync, AnAsymmetryShowsInTheOffsetButStaysWithinTheUncertainty) {
  Random random(2);
  for (const auto& [there, back] : {std::pair{20ms, 80ms}, {80ms, 20ms}, {0ms, 100ms}}) {
    ClockSync sync;
    run(sync, random, {.offset = 1s, .there = there, .back = back}, 0s, 100ms);
    const ClockEstimate clock = sync.estimate();
    EXPECT_EQ(clock.offset - 1s, (there - back) / 2);
    EXPECT_LE(std::chrono::abs(clock.offset - 1s), clock.uncertainty);
  }
}

// Jitter of 5 ms mean: a single exchange is 2.5 ms off, the exchange of least round trip of a
// second 0.2 ms; the separate minima of two seconds stay far below that.
TEST(ClockSync, SeparateMinimaSeeThroughJitter) {
  double squares = 0, worst = 0;
  constexpr int kSeeds = 100;
  for (std::uint64_t seed = 1; seed <= kSeeds; ++seed) {
    ClockSync sync;
    Random random(seed);
    run(sync, random, {.offset = -42s, .there = 10ms, .back = 10ms, .jitter = 5e-3}, 0s, 2s);
    const double error = microseconds(sync.estimate().offset + 42s);
    squares += error * error;
    worst = std::max(worst, std::abs(error));
  }
  RecordProperty("rms_us", std::to_string(std::sqrt(squares / kSeeds)));
  EXPECT_LT(std::sqrt(squares / kSeeds), 100.0);
  EXPECT_LT(worst, 300.0);
}

TEST(ClockSync, AStepOfThePathIsForgottenAfterTheWindow) {
  ClockSync sync;
  Random random(3);
  run(sync, random, {.there = 25ms, .back = 25ms}, 0s, 5s);
  EXPECT_EQ(sync.estimate().round_trip, 50ms);
  run(sync, random, {.there = 100ms, .back = 100ms}, 5s, 6s);
  EXPECT_EQ(sync.estimate().round_trip, 50ms);  // still in the window
  run(sync, random, {.there = 100ms, .back = 100ms}, 6s, 8s);
  EXPECT_EQ(sync.estimate().round_trip, 200ms);
  run(sync, random, {.there = 25ms, .back = 25ms}, 8s, 8005ms);
  EXPECT_EQ(sync.estimate().round_trip, 50ms);  // a faster path counts at once
  EXPECT_EQ(sync.estimate().offset, 0s);
}

TEST(ClockSync, ADriftAddsNoMoreThanItMakesInHalfAWindow) {
  for (const double drift : {100e-6, -100e-6}) {
    ClockSync sync;
    Random random(4);
    run(sync, random, {.there = 50us, .back = 50us, .drift = drift}, 0s, 20s);
    const double now = drift * 20, half_window = std::abs(drift) * seconds(ClockSync::kWindow) / 2;
    EXPECT_NEAR(seconds(sync.estimate().offset), now, half_window * 1.01);
    EXPECT_NEAR(microseconds(sync.estimate().round_trip), 100, 0.1);  // one clock only: no drift
  }
}

TEST(ClockSync, ImpossibleExchangesAreNotUsed) {
  ClockSync sync;
  sync.add({10ms, 20ms, 15ms, 30ms});  // left before it came
  sync.add({10ms, 20ms, 45ms, 30ms});  // held longer than it was away
  EXPECT_FALSE(sync.estimate().valid);
}

TEST(SlidingMinimum, AgreesWithASearchToAGrain) {
  constexpr Duration kWindow = 640ms, kGrain = 10ms;
  for (std::uint64_t seed = 1; seed <= 10; ++seed) {
    Random random(seed);
    SlidingMinimum sliding(kWindow);
    std::deque<std::pair<Duration, Duration>> all;
    Duration now{};
    for (int i = 0; i < 5000; ++i) {
      now += from_seconds(1e-3 * std::floor(random.uniform() * (i % 500 == 0 ? 2000 : 4)));
      const Duration value(static_cast<std::int64_t>(random.bits() % 1000));
      sliding.add(now, value);
      all.emplace_back(now, value);
      while (all.front().first / kGrain <= now / kGrain - 64) all.pop_front();
      const auto least = std::min_element(
          all.begin(), all.end(), [](const auto& a, const auto& b) { return a.second < b.second; });
      ASSERT_EQ(sliding.minimum(), least->second) << "seed " << seed << " step " << i;
    }
  }
}

}  // namespace
}  // namespace farhand
