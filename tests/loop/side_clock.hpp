// A side's own clock against the virtual time all is simulated in: another origin, a rate that is
// off, and steps forward. (A monotonic clock never steps back.)
#pragma once

#include <cstdint>

#include "common/time.hpp"

namespace farhand {

struct ClockError {
  Duration ahead{};      // at the start; not so far behind that the clock would be negative
  std::int64_t ppb = 0;  // parts per thousand million: 1000 are 1 ppm
};

class SideClock {
 public:
  SideClock(TimePoint start, const ClockError& error) noexcept
      : true_(start), local_(start + error.ahead), ppb_(error.ppb) {}

  TimePoint local(TimePoint t) const noexcept { return local_ + scaled(t - true_); }
  // The first instant, not before the last step, at which it shows `local`.
  TimePoint truth(TimePoint local) const noexcept {
    const Duration d = local - local_;
    if (ppb_ == 0 || d <= Duration::zero()) return true_ + (d > Duration::zero() ? d : Duration{});
    TimePoint t = true_ + d - Duration(d.count() * ppb_ / kBillion);
    while (this->local(t) >= local) t -= Duration(1);
    while (this->local(t) < local) t += Duration(1);
    return t;
  }
  void step(TimePoint now, Duration forward) noexcept {
    local_ = local(now) + forward;
    true_ = now;
  }

 private:
  static constexpr std::int64_t kBillion = 1'000'000'000;
  Duration scaled(Duration d) const noexcept { return d + Duration(d.count() * ppb_ / kBillion); }

  TimePoint true_, local_;
  std::int64_t ppb_;
};

}  // namespace farhand
