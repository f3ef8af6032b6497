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

// The samples at the ends of x and y.
struct Extremes {
  std::size_t left = kNone, right = kNone, low = kNone, high = kNone;

  Extremes(std::span<const float> x, std::span<const float> y) {
    for (std::size_t i = 0; i < x.size(); ++i) {
      if (!std::isfinite(x[i]) || !std::isfinite(y[i])) continue;
      if (left == kNone) left = right = low = high = i;
      if (x[i] < x[left]) left = i;
      if (x[i] > x[right]) right = i;
      if (y[i] < y[low]) low = i;
      if (y[i] > y[high]) high = i;
    }
  }
  bool has(std::size_t i) const { return i == left || i == right || i == low || i == high; }
};

// Which cells of the grid the path has been in.
class Visits {
 public:
  enum class Step { stays, to_new, to_seen };

  Visits(double x0, double y0, double cell, int cells)
      : x0_(x0),
        y0_(y0),
        cell_(cell),
        row_(static_cast<std::size_t>(cells) + 1),
        seen_(row_ * row_, false) {}

  Step step(double x, double y) {
    const std::size_t at = index(y - y0_) * row_ + index(x - x0_);
    if (at == at_) return Step::stays;
    at_ = at;
    const bool seen = seen_[at];
    seen_[at] = true;
    return seen ? Step::to_seen : Step::to_new;
  }

 private:
  std::size_t index(double distance) const {
    return std::min(static_cast<std::size_t>(distance / cell_), row_ - 1);
  }
  double x0_, y0_, cell_;
  std::size_t row_;
  std::vector<bool> seen_;
  std::size_t at_ = kNone;
};

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
  const auto edge = [&](std::size_t c) {
    return lo + (hi - lo) * static_cast<double>(c) / static_cast<double>(count);
  };
  std::size_t i = begin;
  for (std::size_t c = 0; c < count; ++c) {
    Bucket bucket{.begin = edge(c)};
    const double stop = edge(c + 1);
    const std::size_t first = i;
    for (; i < end && (t[i] < stop || c + 1 == count); ++i)
      if (std::isfinite(y[i])) bucket.add(i, y);
    // Columns narrower than the distance of samples do not interrupt.
    if (i > first) bucket.draw(pen, t, y, scale);
  }
  return pen.points;
}

std::vector<Point> thin_path(std::span<const float> x, std::span<const float> y, int cells,
                             double scale) {
  const Extremes ends(x, y);
  if (ends.left == kNone) return {};
  const double side = std::max<double>(x[ends.right] - x[ends.left], y[ends.high] - y[ends.low]);
  Visits visits(x[ends.left], y[ends.low], side > 0 ? side / cells : 1, cells);
  Pen pen;
  bool away = true;  // the pen is not where the path is
  for (std::size_t i = 0; i < x.size(); ++i) {
    if (!std::isfinite(x[i]) || !std::isfinite(y[i])) {
      pen.lift(0);
      away = true;
      continue;
    }
    const Visits::Step step = visits.step(x[i], y[i]);
    const bool is_new = step == Visits::Step::to_new || ends.has(i);
    if (!is_new && (away || step == Visits::Step::stays)) continue;
    if (away) pen.lift(0);
    if (away && i > 0 && std::isfinite(x[i - 1]) && std::isfinite(y[i - 1]))
      pen.to(x[i - 1] * scale, y[i - 1] * scale);
    pen.to(x[i] * scale, y[i] * scale);
    away = !is_new;
  }
  return pen.points;
}

}  // namespace farhand
