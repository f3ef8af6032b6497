// When the slave ticks: once per period, phase-locked to the arrivals of the master's messages.
//
// A tick is expected one period after the last. It runs as soon as its message is there, up to
// `window` earlier; it waits for it up to `window` longer and then runs without. A message belongs
// to the expected instant nearest to it: one that missed its tick is used by the next, without
// hurrying that. Each arrival pulls the expected instants towards itself by 1/kGain of its
// distance, so that the slave settles on the master's rhythm (whatever its phase and clock drift),
// while a single late message shifts a tick by no more than the window and jitter does not change
// the rate. The controllers' sample time stays the nominal period.
#pragma once

#include <algorithm>
#include <cstdint>
#include <optional>

#include "common/time.hpp"

namespace farhand {

class PhaseLock {
 public:
  static constexpr int kGain = 8;  // a difference is closed by an eighth per tick

  // period > 0; start is the first expected tick.
  PhaseLock(Duration period, TimePoint start) noexcept
      : period_(period), window_(period / 4), expected_(start) {}

  TimePoint expected() const noexcept { return expected_; }
  TimePoint earliest() const noexcept { return expected_ - window_; }
  TimePoint deadline() const noexcept { return expected_ + window_; }

  // When to tick, given the arrival of the newest message that no tick has used yet.
  TimePoint due(std::optional<TimePoint> arrival) const noexcept {
    const bool own = arrival && *arrival >= expected_ - period_ / 2;
    return own ? std::clamp(*arrival, earliest(), deadline()) : deadline();
  }

  // A tick ended at `now` and used the message that arrived at `arrival`, if there was one. Ticks
  // that it outlasted are skipped and counted, not made up.
  void ticked(TimePoint now, std::optional<TimePoint> arrival) noexcept {
    if (arrival) expected_ += std::clamp(from_nearest(*arrival), -window_, window_) / kGain;
    expected_ += period_;
    if (now > expected_ + window_) {
      const auto behind = (now - expected_) / period_ + 1;
      missed_ += static_cast<std::uint64_t>(behind);
      expected_ += behind * period_;
    }
  }

  std::uint64_t missed() const noexcept { return missed_; }

 private:
  // Between minus and plus half a period: a message that missed the last tick counts as late for
  // it, not as early for the next.
  Duration from_nearest(TimePoint arrival) const noexcept {
    const Duration d = std::max(arrival - expected_, -period_);
    return d < -period_ / 2 ? d + period_ : d;
  }

  Duration period_;
  Duration window_;
  TimePoint expected_;
  std::uint64_t missed_ = 0;
};

}  // namespace farhand
