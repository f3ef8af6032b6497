#include "common/report/envelope.hpp"

#include <algorithm>
#include <cmath>
#include <limits>

namespace farhand {
namespace {

constexpr double kNaN = std::numeric_limits<double>::quiet_NaN();
constexpr std::size_t kNone = std::numeric_limits<std::size_t>::max();

// Appends points, and one interruption at most where samples are missing.
struct Pen {
  std::vector<Point> points;
  void to(double x, double y) { points.push_back({x, y}); }
  void lift(double x) {
    if (!points.empty() && !std::isnan(points.back().y)) points.push_back({x, kNaN});
  }
};

struct Bucket {
  std::size_t lowest = kNone, highest = kNone;
  double begin = 0;

  void add(std::size_t i, std::span<const float> y) {
    if (lowest == kNone) {
      lowest = highest = i;
    } else if (y[i] < y[lowest]) {
      lowest = i;
    } else if (y[i] > y[highest]) {
      highest = i;
    }
  }
  void draw(Pen& pen, std::span<const double> t, std::span<const float> y, double scale) const {
    if (lowest == kNone) return pen.lift(begin);
    const auto [first, second] = std::minmax(lowest, highest);
    pen.to(t[first], y[first] * scale);
    if (second != first) pen.to(t[second], y[second] * scale);
  }
};

void draw_all(Pen& pen, std::span<const double> t, std::span<const float> y, double scale) {
  for (std::size_t i = 0; i < y.size(); ++i)
    if (std::isfinite(y[i]))
      pen.to(t[i], y[i] * scale);
    else
      pen.lift(t[i]);
}

// Indices, in ascending order, of the samples a path keeps whatever their distance.
std::vector<std::size_t> extremes(std::span<const float> x, std::span<const float> y) {
  std::size_t left = kNone, right = kNone, low = kNone, high = kNone;
  for (std::size_t i = 0; i < x.size(); ++i) {
    if (!std::isfinite(x[i]) || !std::isfinite(y[i])) continue;
    if (left == kNone) left = right = low = high = i;
    if (x[i] < x[left]) left = i;
    if (x[i] > x[right]) right = i;
    if (y[i] < y[low]) low = i;
    if (y[i] > y[high]) high = i;
  }
  std::vector<std::size_t> out{left, right, low, high};
  std::sort(out.begin(), out.end());
  return out;
}

}  // namespace

std::vector<Point> envelope(std::span<const double> t, std::span<const float> y, double lo,
                            double hi, int columns, double scale) {
  const auto begin = static_cast<std::size_t>(std::lower_bound(t.begin(), t.end(), lo) - t.begin());
  const auto end = static_cast<std::size_t>(std::upper_bound(t.begin(), t.end(), hi) - t.begin());
  Pen pen;
  if (begin >= end) return {};
  const auto count = static_cast<std::size_t>(std::max(columns, 1));
  if (end - begin <= 2 * count) {
    draw_all(pen, t.subspan(begin, end - begin), y.subspan(begin, end - begin), scale);
    return pen.points;
  }
  std::size_t i = begin;
  for (std::size_t c = 0; c < count; ++c) {
    const double width = (hi - lo) / static_cast<double>(count);
    Bucket bucket{.begin = lo + width * static_cast<double>(c)};
    const double stop = c + 1 == count ? hi : bucket.begin + width;
    const std::size_t first = i;
    for (; i < end && (t[i] < stop || c + 1 == count); ++i)
      if (std::isfinite(y[i])) bucket.add(i, y);
    // Columns narrower than the distance of samples do not interrupt.
    if (i > first) bucket.draw(pen, t, y, scale);
  }
  return pen.points;
}

std::vector<Point> thin_path(std::span<const float> x, std::span<const float> y, double spacing,
                             double scale) {
  const std::vector<std::size_t> kept = extremes(x, y);
  auto next_kept = kept.begin();
  Pen pen;
  for (std::size_t i = 0; i < x.size(); ++i) {
    bool keep = false;
    while (next_kept != kept.end() && *next_kept == i) keep = true, ++next_kept;
    if (!std::isfinite(x[i]) || !std::isfinite(y[i])) {
      pen.lift(x[i]);
      continue;
    }
    const Point p{x[i] * scale, y[i] * scale};
    const bool first = pen.points.empty() || std::isnan(pen.points.back().y);
    if (keep || first || i + 1 == x.size() || std::abs(p.x - pen.points.back().x) >= spacing ||
        std::abs(p.y - pen.points.back().y) >= spacing)
      pen.points.push_back(p);
  }
  return pen.points;
}

}  // namespace farhand
