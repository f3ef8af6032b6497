// A bad network in a box, one direction: datagrams go in with the time, and come out late, changed,
// twice or never. Sans I/O and seeded: same configuration, seed and calls, same bits out. Each
// datagram draws the same number of random values whatever is configured, so a change of the delay
// leaves it undecided neither which datagrams are lost nor which are doubled.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <optional>
#include <span>
#include <vector>

#include "common/random.hpp"
#include "common/time.hpp"
#include "common/wire.hpp"

namespace farhand {

enum class JitterKind : std::uint8_t {
  uniform,  // +- jitter_ms around the delay
  normal,   // standard deviation jitter_ms around the delay
  gamma,    // shape 2, mean jitter_ms, on top of the delay: the usual shape of a queue
};

// Delays below zero become zero. Ratios are probabilities per datagram in [0, 1].
struct ImpairmentConfig {
  double delay_ms = 0;
  double jitter_ms = 0;
  JitterKind jitter_kind = JitterKind::gamma;
  bool keep_order = false;  // jitter delays those behind too, as a single queue does
  double loss_ratio = 0;    // independent of one another
  // Gilbert-Elliott: losses in bursts of mean length 1 / burst_leave_ratio, in the long run
  // burst_loss_ratio enter / (enter + leave) of all.
  double burst_enter_ratio = 0;
  double burst_leave_ratio = 1;
  double burst_loss_ratio = 1;  // within a burst
  double duplicate_ratio = 0;   // a second copy with a jitter of its own
  double reorder_ratio = 0;     // held back by reorder_hold_ms
  double reorder_hold_ms = 5;
  double corrupt_ratio = 0;  // one bit flipped
};

// pushed == lost + overflowed + oversized + (popped + waiting - duplicated)
struct ImpairmentCounters {
  std::uint64_t pushed = 0;
  std::uint64_t popped = 0;
  std::uint64_t lost = 0;
  std::uint64_t duplicated = 0;
  std::uint64_t held_back = 0;
  std::uint64_t corrupted = 0;
  std::uint64_t overflowed = 0;  // no free place
  std::uint64_t oversized = 0;   // above kMaxDatagramBytes
};

class Impairment {
 public:
  // Without a configuration everything passes, in order, after this long.
  static constexpr Duration kPlainDelay = std::chrono::microseconds(50);

  // Allocates the room for `capacity` datagrams under way; nothing after that. 2048 hold two
  // seconds at 1 kHz. Throws, naming the field, if a ratio is outside [0, 1] or a time is negative
  // or not finite.
  Impairment(const std::optional<ImpairmentConfig>& config, std::uint64_t seed,
             std::size_t capacity = 2048);

  void push(std::span<const std::byte> datagram, TimePoint now) noexcept;

  // When the next datagram comes out; nothing if none is under way.
  std::optional<TimePoint> next_due() const noexcept;

  // The next datagram due by `now`, copied to the front of `out` (kMaxDatagramBytes or more); empty
  // if none is. In the order of due times, equal ones in the order of arrival.
  std::span<const std::byte> pop(TimePoint now, std::span<std::byte> out) noexcept;

  std::size_t waiting() const noexcept { return waiting_; }
  const ImpairmentCounters& counters() const noexcept { return counters_; }

 private:
  struct Slot {
    std::array<std::byte, kMaxDatagramBytes> bytes;
    std::size_t size = 0;
  };
  struct Due {
    TimePoint at;
    std::uint64_t order = 0;
    std::size_t slot = 0;
  };
  static bool later(const Due& a, const Due& b) noexcept;

  bool lost() noexcept;
  Duration transit(bool held_back) noexcept;
  double jitter() noexcept;
  void schedule(std::span<const std::byte> datagram, TimePoint at,
                std::optional<std::size_t> bit) noexcept;

  ImpairmentConfig config_;
  Random fate_;    // a fixed number of draws per datagram
  Random timing_;  // as many as the jitter takes
  bool in_burst_ = false;
  TimePoint last_due_ = TimePoint::min();
  std::uint64_t order_ = 0;
  std::size_t waiting_ = 0;
  std::vector<Slot> slots_;
  std::vector<Due> heap_;  // the first waiting_ are a heap, the rest hold the free slots
  ImpairmentCounters counters_;
};

}  // namespace farhand
