// Values to pixels, and polylines as the d attribute of an SVG path in tenths of a pixel.
#pragma once

#include <algorithm>
#include <cmath>
#include <span>
#include <string>

#include "common/report/chart.hpp"

namespace farhand {

// An axis laid out between two pixels; `from` belongs to lo.
struct PixelScale {
  double lo = 0, hi = 1;
  bool log = false;
  double from = 0, to = 1;

  // Values beyond the axis are put on its end.
  double operator()(double v) const noexcept {
    const double share = log ? std::log(v / lo) / std::log(hi / lo) : (v - lo) / (hi - lo);
    return from + std::clamp(share, 0.0, 1.0) * (to - from);
  }
  bool shows(double v) const noexcept { return std::isfinite(v) && (!log || v > 0); }
};

// Relative moves; points that lie on a horizontal run between their neighbours are left out, which
// changes nothing in the picture. Empty if no two neighbouring points can be drawn.
std::string path(std::span<const Point> points, const PixelScale& x, const PixelScale& y);

}  // namespace farhand
