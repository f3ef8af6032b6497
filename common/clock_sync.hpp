// The peer's clock from four stamps per exchange (RFC 5905 section 8, minima taken separately).
// With
//
//   t1 ours, sent -> t2 theirs, received -> t3 theirs, sent -> t4 ours, received
//
// d1 = t2 - t1 and d2 = t4 - t3 are the two one-way delays plus and minus the offset. The minimum
// of each over a window is taken on its own, since the fastest way there and the fastest way back
// rarely meet in one exchange (5 to 10 times better than the exchange of least round trip):
//
//   offset = (min d1 - min d2) / 2        their clock minus ours
//
// The clocks' drift is the slope of a line fitted by least squares through (d1 - d2) / 2 of the
// minima of each quarter second, over the last 32 s. The minima of the window are brought to the
// present along it. A slope that hardly stands out of its own uncertainty s is shrunk towards none
// (Breiman 1995, the non-negative garrotte) and towards what quartz clocks do:
//
//   drift = slope max(0, 1 - kShrink s^2 / slope^2) / (1 + s^2 / kUsualDrift^2)
//
// An asymmetry of the path cannot be seen: ways of 20 and 80 ms look like ways of 50 ms and clocks
// 30 ms apart. Without drift the error is at most half the least round trip, all of it.
//
// What is far faster than the window's fastest, one way or both, is a step of a clock or another
// route: all from before it is forgotten, within two quarter seconds. What is far slower is left
// out of the fit, and counts when the window has nothing else.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>

#include "common/time.hpp"

namespace farhand {

struct ClockEstimate {
  bool valid = false;      // an exchange is in the window
  Duration offset{};       // peer's clock minus ours, as of the last exchange
  Duration round_trip{};   // least of the window, the peer's hold taken off
  Duration uncertainty{};  // of the offset: round_trip / 2 and drift_uncertainty over the window
  double drift = 0;  // of the offset, per second: 1e-6 is 1 ppm; 0 while it does not stand out
  double drift_uncertainty = 0;
};

// The stamps as time since their clocks' epochs, within +- kMaxStamp.
struct Exchange {
  Duration t1{}, t2{}, t3{}, t4{};
};

// An exchange costs a few comparisons, and the first of each quarter second a fit over at most
// kHistory minima.
class ClockSync {
 public:
  static constexpr Duration kGrain = std::chrono::milliseconds(250);
  static constexpr Duration kWindow = 40 * kGrain;
  static constexpr std::size_t kHistory = 128;   // grains the drift is fitted over
  static constexpr std::size_t kFewest = 8;      // below, no drift is fitted
  static constexpr double kUsualDrift = 100e-6;  // between two quartz clocks; assumed at first
  static constexpr double kLargestDrift = 1e-3;  // beyond, it was no drift: all is forgotten
  static constexpr double kShrink = 3;
  static constexpr Duration kFinest = std::chrono::microseconds(20);  // no step is smaller

  // An exchange whose hold or round trip comes out negative is not used. Times t4 must not run
  // backwards by more than a grain.
  void add(const Exchange& x) noexcept;
  void clear() noexcept { *this = {}; }
  ClockEstimate estimate() const noexcept;
  // How much longer the way here took than the fastest of the window: by the stamps t3 and t4, or
  // by the round trip if that says less, since a clock's step shows in the first alone and a slow
  // way there in the second alone. 0 while no exchange is in the window.
  Duration lateness(const Exchange& x) const noexcept;

 private:
  struct Sample {
    Duration at{}, value{};
  };
  // The fastest of a stretch of time.
  struct Grain {
    std::int64_t number = 0;
    Sample forward, backward;
    Duration round_trip{};
    bool steady = true;  // as fast as the window's

    Duration middle() const noexcept { return (forward.at + backward.at) / 2; }
    Duration offset() const noexcept { return (forward.value - backward.value) / 2; }
  };
  // The same of all of the window, brought to the time `at` along the drift.
  struct Floors {
    bool empty = true;
    Duration since{}, forward{}, backward{}, round_trip{};
    void lower(const Floors& other) noexcept;
  };

  Duration at_origin(const Sample& s, double sign) const noexcept;
  Floors floors(const Grain& g) const noexcept;
  Floors floors() const noexcept;  // of all of the window
  void close(std::int64_t next) noexcept;
  void append(Grain grain) noexcept;
  void forget() noexcept;
  void fit() noexcept;
  const Grain& closed(std::size_t i) const noexcept { return ring_[(first_ + i) % kHistory]; }

  std::array<Grain, kHistory> ring_{};  // closed grains, oldest first
  std::size_t first_ = 0, size_ = 0;
  bool has_open_ = false;
  Grain open_;
  Duration last_{}, origin_{};
  Floors window_;  // of the closed grains
  bool fitted_ = false;
  double drift_ = 0, drift_uncertainty_ = kUsualDrift;
  Duration spread_{};  // standard deviation of a grain's (d1 - d2) / 2 around the line
};

}  // namespace farhand
