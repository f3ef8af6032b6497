#include "common/phase_lock.hpp"

#include <gtest/gtest.h>

#include "common/random.hpp"

namespace farhand {
namespace {

using std::chrono::microseconds;
constexpr Duration kPeriod = microseconds(1000);
constexpr TimePoint kStart{};

// Runs the lock against messages that arrive at `phase` + k `spacing`; returns the tick instants.
std::vector<TimePoint> run(Duration phase, Duration spacing, int ticks) {
  PhaseLock lock(kPeriod, kStart);
  TimePoint arrival = kStart + phase, now = kStart;
  std::vector<TimePoint> out;
  for (int k = 0; k < ticks; ++k) {
    std::optional<TimePoint> newest;
    for (; arrival <= lock.due(newest); arrival += spacing) newest = arrival;
    now = lock.due(newest);
    lock.ticked(now, newest);
    out.push_back(now);
  }
  return out;
}

TEST(PhaseLock, SettlesOnTheArrivalsFromAnyPhase) {
  for (int phase = 0; phase < 1000; phase += 50) {
    const auto ticks = run(microseconds(phase), kPeriod, 400);
    const Duration late = (ticks.back() - kStart - microseconds(phase)) % kPeriod;
    EXPECT_EQ(late, Duration(0)) << "phase " << phase << " us";
  }
}

TEST(PhaseLock, FollowsAClockThatDrifts) {
  const Duration spacing = Duration(1000100);  // 100 ppm slow
  const auto ticks = run(microseconds(300), spacing, 20000);
  const Duration late = (ticks.back() - kStart - microseconds(300)) % spacing;
  EXPECT_LT(late, microseconds(5));
  EXPECT_NEAR(static_cast<double>((ticks[19999] - ticks[9999]).count()), 1.00010e10, 1e6);
}

TEST(PhaseLock, JitterFarBeyondTheWindowHardlyChangesTheRate) {
  Random random(5);
  PhaseLock lock(kPeriod, kStart);
  std::vector<TimePoint> arrivals;
  for (int k = 0; k < 50000; ++k)
    arrivals.push_back(kStart + k * kPeriod + from_seconds(0.003 * random.uniform()));
  std::sort(arrivals.begin(), arrivals.end());
  std::size_t next = 0;
  int ticks = 0;
  for (; next < arrivals.size(); ++ticks) {
    std::optional<TimePoint> newest;
    while (next < arrivals.size() && arrivals[next] <= lock.due(newest)) newest = arrivals[next++];
    lock.ticked(lock.due(newest), newest);
  }
  EXPECT_NEAR(ticks, 50000, 250);
}

TEST(PhaseLock, WithoutArrivalsKeepsTheNominalRate) {
  const auto ticks = run(std::chrono::hours(1), kPeriod, 1000);
  for (std::size_t k = 1; k < ticks.size(); ++k) EXPECT_EQ(ticks[k] - ticks[k - 1], kPeriod);
}

TEST(PhaseLock, OneLateMessageShiftsOneTickByNoMoreThanTheWindow) {
  PhaseLock lock(kPeriod, kStart);
  lock.ticked(kStart, kStart);
  EXPECT_EQ(lock.deadline() - kStart, kPeriod + kPeriod / 4);
  lock.ticked(lock.deadline(), {});
  EXPECT_EQ(lock.deadline() - kStart, 2 * kPeriod + kPeriod / 4);
}

TEST(PhaseLock, AStallIsSkippedAndCountedNotMadeUp) {
  PhaseLock lock(kPeriod, kStart);
  const TimePoint late = kStart + microseconds(7300);
  lock.ticked(late, {});
  EXPECT_GT(lock.deadline(), late);
  EXPECT_LE(lock.earliest(), late + kPeriod);
  EXPECT_EQ(lock.missed(), 7u);
}

}  // namespace
}  // namespace farhand
