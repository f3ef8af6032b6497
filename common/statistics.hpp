// Running root mean square and peak of a quantity; NaN never enters.
#pragma once

#include <algorithm>
#include <cmath>
#include <cstdint>

namespace farhand {

// Above this force [N] the tool counts as touching.
inline constexpr double kContactForce = 0.5;

struct Rms {
  std::uint64_t count = 0;
  double sum_squares = 0;
  double peak = 0;  // of the size

  void add(double x) noexcept {
    if (!std::isfinite(x)) return;
    ++count;
    sum_squares += x * x;
    peak = std::max(peak, std::abs(x));
  }
  double value() const noexcept {
    return count > 0 ? std::sqrt(sum_squares / static_cast<double>(count)) : 0;
  }
};

}  // namespace farhand
