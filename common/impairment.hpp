// A bad network in a box, one direction: datagrams go in with the time, and come out late, changed,
// twice or never. Sans I/O and seeded: same configuration, seed and calls, same bits out. Each
// datagram draws its fate, its jitter and its copy's jitter from generators of their own whatever
// is configured, so a change of one impairment leaves the draws of all others alone.
//
// A datagram meets a blackout, then the rate cap, then the losses, then the delays. Times of steps,
// blackouts and drift count from the first datagram.
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

// All is lost from at_s for length_s, again every period_s (0: once). None if length_s is 0.
struct Blackout {
  double at_s = 0;
  double length_s = 0;
  double period_s = 0;
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
  // Spikes: now and then the network stops for spike_ms, and what came meanwhile passes at its end.
  double spike_ms = 0;
  double spike_pause_s = 1;  // mean of the exponential pauses in between
  // A longer way for a while: step_ms more from step_at_s for step_length_s (0: to the end).
  double step_ms = 0;
  double step_at_s = 0;
  double step_length_s = 0;
  double delay_drift_ms_per_s = 0;  // what the delay gains
  std::array<Blackout, 8> blackouts{};
  // Token bucket of cap_burst_bytes, filled at the rate (0: no cap). One that would have to wait
  // longer than cap_queue_bytes take at the rate is dropped. Bytes of datagrams, without headers.
  double cap_kbit_per_s = 0;
  double cap_burst_bytes = 1500;
  double cap_queue_bytes = 15000;
};

// pushed == lost + blacked_out + capped + overflowed + oversized +
//           (popped + waiting - duplicated)
struct ImpairmentCounters {
  std::uint64_t pushed = 0;
  std::uint64_t popped = 0;
  std::uint64_t lost = 0;
  std::uint64_t blacked_out = 0;
  std::uint64_t capped = 0;  // the cap's queue was full
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
  bool blacked_out(TimePoint now) const noexcept;
  // When the cap lets it go; nothing if its queue is full.
  std::optional<TimePoint> through_cap(std::size_t bytes, TimePoint now) noexcept;
  double jitter_ms(Random& random) noexcept;
  double way_ms(TimePoint now) const noexcept;  // delay, step and drift
  Duration stalled(TimePoint now) noexcept;
  void schedule(std::span<const std::byte> datagram, TimePoint at,
                std::optional<std::size_t> bit) noexcept;

  ImpairmentConfig config_;
  Random fate_;                  // a fixed number of draws per datagram
  Random timing_, copy_timing_;  // as many as the jitter takes
  Random pauses_;
  std::optional<TimePoint> begin_;
  TimePoint stall_{}, bucket_full_ = TimePoint::min();
  bool in_burst_ = false;
  TimePoint last_due_ = TimePoint::min();
  std::uint64_t order_ = 0;
  std::size_t waiting_ = 0;
  std::vector<Slot> slots_;
  std::vector<Due> heap_;  // the first waiting_ are a heap, the rest hold the free slots
  ImpairmentCounters counters_;
};

}  // namespace farhand
