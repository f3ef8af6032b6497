// Time as the control code sees it: always an argument, never read. The shells fill it from
// CLOCK_MONOTONIC, the virtual loop from its own counter; only differences mean anything.
#pragma once

#include <chrono>

namespace farhand {

using Duration = std::chrono::nanoseconds;
using TimePoint = std::chrono::time_point<std::chrono::steady_clock, Duration>;

constexpr double seconds(Duration d) noexcept {
  return std::chrono::duration<double>(d).count();
}
constexpr Duration from_seconds(double s) noexcept {
  return Duration(static_cast<Duration::rep>(s * 1e9 + (s < 0 ? -0.5 : 0.5)));
}

}  // namespace farhand
