#include "common/phase_lock.hpp"

#include <gtest/gtest.h>

namespace farhand {
namespace {

using std::chrono::microseconds;
constexpr Duration kPeriod = microseconds(1000);
constexpr TimePoint kStart{};

// Runs the lock against messages that arrive at `phase` + k `spacing`; returns the tick instants.
std::vector<TimePoint> run(Duration phase, Duration spacing, int ticks) {
  PhaseLock lock(kPeriod, kStart);
  TimePoint arrival = kStart + phase, now = kStart - kPeriod;
  std::vector<TimePoint> out;
  for (int k = 0; k < ticks; ++k) {
    const TimePoint ready = std::max({lock.earliest(), arrival, now});
    const bool on_arrival = ready <= lock.deadline();
    now = on_arrival ? ready : lock.deadline();
    while (arrival <= now) arrival += spacing;
    lock.ticked(now, on_arrival);
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

TEST(PhaseLock, WithoutArrivalsKeepsTheNominalRate) {
  const auto ticks = run(std::chrono::hours(1), kPeriod, 1000);
  for (std::size_t k = 1; k < ticks.size(); ++k) EXPECT_EQ(ticks[k] - ticks[k - 1], kPeriod);
}

TEST(PhaseLock, OneLateMessageShiftsOneTickByNoMoreThanTheWindow) {
  PhaseLock lock(kPeriod, kStart);
  lock.ticked(kStart, true);
  EXPECT_EQ(lock.deadline() - kStart, kPeriod + kPeriod / 4);
  lock.ticked(lock.deadline(), false);
  EXPECT_EQ(lock.deadline() - kStart, 2 * kPeriod + kPeriod / 4);
}

TEST(PhaseLock, AStallIsSkippedAndCountedNotMadeUp) {
  PhaseLock lock(kPeriod, kStart);
  const TimePoint late = kStart + microseconds(7300);
  lock.ticked(late, false);
  EXPECT_GT(lock.deadline(), late);
  EXPECT_LE(lock.earliest(), late + kPeriod);
  EXPECT_EQ(lock.missed(), 7u);
}

}  // namespace
}  // namespace farhand
