// When the slave ticks: once per period, phase-locked to the arrivals of the master's messages.
//
// A tick is expected one period after the last. It may run up to `window` earlier, as soon as a
// message is there, and waits up to `window` longer for one; then it runs without. Each arrival
// pulls the expected instant towards itself by `kGain` of the difference, so that the slave settles
// on the master's rhythm (whatever its phase and clock drift) while a single late message shifts a
// tick by no more than the window. The controllers' sample time stays the nominal period.
#pragma once

#include <algorithm>
#include <cstdint>

#include "common/time.hpp"

namespace farhand {

class PhaseLock {
 public:
  static constexpr int kGain = 8;  // a difference is closed by an eighth per tick

  // period > 0; start is the first expected tick.
  PhaseLock(Duration period, TimePoint start) noexcept
      : period_(period), window_(period / 4), expected_(start) {}

  TimePoint earliest() const noexcept { return expected_ - window_; }
  TimePoint deadline() const noexcept { return expected_ + window_; }

  // A tick ran at `now`, on an arrival or at the deadline. Ticks that a stalled machine missed are
  // skipped and counted, not made up.
  void ticked(TimePoint now, bool on_arrival) noexcept {
    if (on_arrival) expected_ += std::clamp(now - expected_, -window_, window_) / kGain;
    expected_ += period_;
    if (now > expected_ + window_) {
      const auto behind = (now - expected_) / period_ + 1;
      missed_ += static_cast<std::uint64_t>(behind);
      expected_ += behind * period_;
    }
  }

  std::uint64_t missed() const noexcept { return missed_; }

 private:
  Duration period_;
  Duration window_;
  TimePoint expected_;
  std::uint64_t missed_ = 0;
};

}  // namespace farhand
