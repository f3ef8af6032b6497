#include "common/clock_sync.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <vector>

#include "common/random.hpp"
#include "tests/support/allocations.hpp"

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
    EXPECT_EQ(clock.uncertainty, 7ms + 900ns);  // 100 ppm of 9 ms
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

// Errors of the offset over seeds [us].
struct Errors {
  double sum = 0, squares = 0, worst = 0;
  int count = 0;
  void add(double error) {
    sum += error;
    squares += error * error;
    worst = std::max(worst, std::abs(error));
    ++count;
  }
  double mean() const { return sum / count; }
  double deviation() const { return std::sqrt(squares / count - mean() * mean()); }
  double rms() const { return std::sqrt(squares / count); }
};

constexpr int kSeeds = 300;

// At each of `times`, over the seeds, with the jitter of the acceptance figures: 5 ms mean each
// way.
std::vector<Errors> errors_after(const std::vector<Duration>& times, double drift) {
  const Path path{.offset = -42s, .there = 10ms, .back = 10ms, .jitter = 5e-3, .drift = drift};
  std::vector<Errors> out(times.size());
  for (std::uint64_t seed = 1; seed <= kSeeds; ++seed) {
    ClockSync sync;
    Random random(seed);
    for (std::size_t i = 0; i < times.size(); ++i) {
      run(sync, random, path, i == 0 ? 0s : times[i - 1], times[i]);
      const ClockEstimate clock = sync.estimate();
      const double error =
          microseconds(clock.offset - path.offset) - 1e6 * drift * (seconds(times[i]) + 0.02);
      out[i].add(error);
      EXPECT_LE(std::abs(error), microseconds(clock.uncertainty));
    }
  }
  for (std::size_t i = 0; i < times.size(); ++i)
    std::printf("drift %4.0f ppm, after %2.0f s: mean %6.1f us, sd %5.1f us, worst %6.1f us\n",
                1e6 * drift, seconds(times[i]), out[i].mean(), out[i].deviation(), out[i].worst);
  return out;
}

// A single exchange is 2.5 ms off, the exchange of least round trip of a second 0.2 ms. In theory:
// the least of n samples of such jitter, theta = 2.5 ms, has a deviation of 0.655 theta / sqrt(n),
// and half the difference of two of them 0.46 theta / sqrt(n): 37 us and 12 us.
TEST(ClockSync, SeparateMinimaSeeThroughJitter) {
  const auto errors = errors_after({1s, 10s}, 0);
  EXPECT_LE(errors[0].rms(), 40.0);
  EXPECT_LE(errors[1].rms(), 15.0);
}

// A line through a window is at its end, the present, twice as uncertain as its middle: 15 us
// become 30. When the fit has run on for longer than the window, the drift costs no more. In the
// first seconds it cannot be told from jitter, and is on average half a window's worth.
TEST(ClockSync, ADriftIsLearntAndCostsNothingInTheEnd) {
  for (const double drift : {100e-6, -100e-6}) {
    const auto errors = errors_after({1s, 10s, 30s}, drift);
    const double half_window = 1e6 * std::abs(drift) / 2;
    EXPECT_LE(errors[0].rms(), std::hypot(40.0, half_window) * 1.05);
    EXPECT_LE(errors[1].rms(), 30.0);
    EXPECT_LE(errors[2].rms(), 15.0);
  }
}

TEST(ClockSync, WithoutJitterADriftIsExact) {
  for (const double drift : {100e-6, 3e-6, -100e-6}) {
    ClockSync sync;
    Random random(4);
    run(sync, random, {.there = 50us, .back = 50us, .drift = drift}, 0s, 20s);
    const ClockEstimate clock = sync.estimate();
    EXPECT_NEAR(clock.drift, drift, 1e-9);
    EXPECT_NEAR(microseconds(clock.offset), 1e6 * drift * 20, 0.2);  // in 0.2 ms and a round trip
    EXPECT_NEAR(microseconds(clock.round_trip), 100, 0.1);           // one clock only: no drift
    EXPECT_NEAR(microseconds(clock.uncertainty), 50, 0.1);
  }
}

TEST(ClockSync, UntilTheDriftIsKnownTheUncertaintyCountsTheUsualOne) {
  ClockSync sync;
  Random random(5);
  run(sync, random, {.there = 50us, .back = 50us, .drift = 100e-6}, 0s, 1s);
  const ClockEstimate clock = sync.estimate();
  EXPECT_EQ(clock.drift, 0);
  EXPECT_EQ(clock.drift_uncertainty, ClockSync::kUsualDrift);
  EXPECT_NEAR(microseconds(clock.uncertainty), 150, 0.2);  // of 0.999 s
  EXPECT_NEAR(microseconds(clock.offset), 50, 0.3);
}

// The step's own quarter second and the next are lost; then come a quarter second's minima, of a
// deviation of 73 us, and in the end a window's.
TEST(ClockSync, AStepOfTheClockIsRecoveredFrom) {
  for (const Duration step : {Duration(1s), Duration(-2ms), Duration(20ms)}) {
    Errors soon, late;
    for (std::uint64_t seed = 1; seed <= 100; ++seed) {
      ClockSync sync;
      Random random(seed);
      Path path{.offset = 3s, .there = 10ms, .back = 10ms, .jitter = 5e-3};
      const auto error = [&] { return microseconds(sync.estimate().offset - path.offset); };
      const Duration at = 20s + 1ms * static_cast<std::int64_t>(random.bits() % 250);
      run(sync, random, path, 0s, at);
      path.offset += step;
      run(sync, random, path, at, at + 750ms);
      soon.add(error());
      run(sync, random, path, at + 750ms, at + 10500ms);
      late.add(error());
    }
    std::printf("step %g ms: sd %.1f us after 0.75 s, worst %.1f us; %.1f us after 10.5 s\n",
                1e3 * seconds(step), soon.rms(), soon.worst, late.rms());
    EXPECT_LE(soon.worst, 5 * 73);
    EXPECT_LE(late.rms(), 15.0);
  }
}

// Slower one way only: no step of a clock, and the old minima stay good.
TEST(ClockSync, ARouteThatGetsSlowerOneWayIsNoStep) {
  ClockSync sync;
  Random random(6);
  run(sync, random, {.there = 10ms, .back = 10ms, .jitter = 1e-4}, 0s, 10s);
  run(sync, random, {.there = 60ms, .back = 10ms, .jitter = 1e-4}, 10s, 15s);
  EXPECT_NEAR(microseconds(sync.estimate().offset), 0, 20);
}

TEST(ClockSync, ASilenceLongerThanAllMemoryBeginsAnew) {
  ClockSync sync;
  Random random(7);
  run(sync, random, {.offset = 1s, .there = 10ms, .back = 10ms}, 0s, 20s);
  run(sync, random, {.offset = 2s, .there = 11ms, .back = 11ms}, 100s, 100s + 2ms);
  EXPECT_EQ(sync.estimate().offset, 2s);
  EXPECT_EQ(sync.estimate().round_trip, 22ms);
}

TEST(ClockSync, AStepOfThePathIsForgottenAfterTheWindow) {
  ClockSync sync;
  Random random(3);
  run(sync, random, {.there = 25ms, .back = 25ms}, 0s, 20s);
  EXPECT_EQ(sync.estimate().round_trip, 50ms);
  run(sync, random, {.there = 100ms, .back = 100ms}, 20s, 25s);
  EXPECT_EQ(sync.estimate().round_trip, 50ms);  // still in the window
  run(sync, random, {.there = 100ms, .back = 100ms}, 25s, 31s);
  EXPECT_EQ(sync.estimate().round_trip, 200ms);
  run(sync, random, {.there = 25ms, .back = 25ms}, 31s, 31005ms);
  EXPECT_EQ(sync.estimate().round_trip, 50ms);  // a faster path counts at once
  EXPECT_EQ(sync.estimate().offset, 0s);
}

TEST(ClockSync, ImpossibleExchangesAreNotUsed) {
  ClockSync sync;
  sync.add({10ms, 20ms, 15ms, 30ms});  // left before it came
  sync.add({10ms, 20ms, 45ms, 30ms});  // held longer than it was away
  EXPECT_FALSE(sync.estimate().valid);
}

TEST(ClockSync, TakesNothingFromTheHeap) {
  ClockSync sync;
  Random random(8);
  EXPECT_EQ(allocations_in([&] {
              run(sync, random, {.there = 1ms, .back = 1ms, .jitter = 1e-3}, 0s, 5s);
              sync.estimate();
            }),
            0u);
}

}  // namespace
}  // namespace farhand
