// The peer's clock from four stamps per exchange (RFC 5905 section 8, minima taken separately).
// With
//
//   t1 ours, sent -> t2 theirs, received -> t3 theirs, sent -> t4 ours, received
//
// d1 = t2 - t1 and d2 = t4 - t3 are the two one-way delays plus and minus the offset. The minimum
// of each over a sliding window is taken on its own, since the fastest way there and the fastest
// way back rarely meet in one exchange (5 to 10 times better than the exchange of least round
// trip):
//
//   offset = (min d1 - min d2) / 2        their clock minus ours
//
// An asymmetry of the path cannot be seen. It is bounded by uncertainty = least round trip / 2; a
// drift between the clocks adds at most drift * window / 2.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>

#include "common/time.hpp"

namespace farhand {

struct ClockEstimate {
  bool valid = false;      // an exchange is in the window
  Duration offset{};       // peer's clock minus ours
  Duration round_trip{};   // least of the window, the peer's hold taken off
  Duration uncertainty{};  // of the offset
};

// The stamps as time since their clocks' epochs, within +- kMaxStamp.
struct Exchange {
  Duration t1{}, t2{}, t3{}, t4{};
};

// Minimum of the samples of the last `window`, to a grain of window / kGrains, in constant
// amortised time: a queue whose values only rise, at most one per grain.
class SlidingMinimum {
 public:
  explicit SlidingMinimum(Duration window) noexcept : grain_(window / kGrains) {}

  // Times must not run backwards by more than a grain.
  void add(Duration at, Duration value) noexcept;
  bool empty() const noexcept { return size_ == 0; }
  Duration minimum() const noexcept { return entry(0).value; }
  void clear() noexcept { size_ = 0; }

 private:
  static constexpr std::int64_t kGrains = 64;
  static constexpr std::size_t kCapacity = kGrains + 1;
  struct Entry {
    std::int64_t grain = 0;
    Duration value{};
  };
  const Entry& entry(std::size_t i) const noexcept { return ring_[(first_ + i) % kCapacity]; }
  const Entry& back() const noexcept { return entry(size_ - 1); }

  Duration grain_;
  std::array<Entry, kCapacity> ring_{};
  std::size_t first_ = 0;
  std::size_t size_ = 0;
};

class ClockSync {
 public:
  static constexpr Duration kWindow = std::chrono::seconds(2);

  explicit ClockSync(Duration window = kWindow) noexcept
      : forward_(window), backward_(window), round_trip_(window) {}

  // An exchange whose hold or round trip comes out negative is not used.
  void add(const Exchange& x) noexcept;
  void clear() noexcept;
  ClockEstimate estimate() const noexcept;  // as of the last exchange

 private:
  SlidingMinimum forward_, backward_, round_trip_;
};

}  // namespace farhand
