#include "common/clock_sync.hpp"

namespace farhand {

void SlidingMinimum::add(Duration at, Duration value) noexcept {
  const std::int64_t grain = at / grain_;
  while (size_ > 0 && entry(0).grain <= grain - kGrains) {
    first_ = (first_ + 1) % kCapacity;
    --size_;
  }
  while (size_ > 0 && back().value >= value) --size_;
  if (size_ > 0 && back().grain >= grain) return;
  ring_[(first_ + size_) % kCapacity] = {grain, value};
  ++size_;
}

void ClockSync::add(const Exchange& x) noexcept {
  const Duration hold = x.t3 - x.t2, round_trip = x.t4 - x.t1 - hold;
  if (hold < Duration::zero() || round_trip < Duration::zero()) return;
  forward_.add(x.t4, x.t2 - x.t1);
  backward_.add(x.t4, x.t4 - x.t3);
  round_trip_.add(x.t4, round_trip);
}

void ClockSync::clear() noexcept {
  forward_.clear();
  backward_.clear();
  round_trip_.clear();
}

ClockEstimate ClockSync::estimate() const noexcept {
  if (round_trip_.empty()) return {};
  const Duration round_trip = round_trip_.minimum();
  return {.valid = true,
          .offset = (forward_.minimum() - backward_.minimum()) / 2,
          .round_trip = round_trip,
          .uncertainty = round_trip / 2};
}

}  // namespace farhand
