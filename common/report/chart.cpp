#include "common/report/chart.hpp"

#include <algorithm>
#include <cmath>

namespace farhand {
namespace {

struct Bounds {
  double lo = std::numeric_limits<double>::infinity();
  double hi = -std::numeric_limits<double>::infinity();

  void add(double v, bool log) noexcept {
    if (!std::isfinite(v) || (log && v <= 0)) return;
    lo = std::min(lo, v);
    hi = std::max(hi, v);
  }
  void add(const Bounds& other) noexcept {
    lo = std::min(lo, other.lo);
    hi = std::max(hi, other.hi);
  }
  bool empty() const noexcept { return lo > hi; }
};

Bounds bounds(const Panel& panel, double Point::*coordinate, bool log) {
  Bounds b;
  for (const Line& line : panel.lines)
    for (const Point& p : line.points)
      if (!std::isnan(p.y)) b.add(p.*coordinate, log);
  return b;
}

void reach_levels(Bounds& b, const Panel& panel) {
  const Bounds data = b;
  for (const double level : panel.levels)
    if ((level > 0 && data.hi >= 0.5 * level) || (level < 0 && data.lo <= 0.5 * level))
      b.add(level, panel.y.log);
}

// `room` of the span is added at each end.
void set_open_ends(Axis& axis, Bounds b, double room) {
  if (b.empty()) b = axis.log ? Bounds{1, 10} : Bounds{0, 1};
  if (axis.log) {
    const double factor = std::max(std::pow(b.hi / b.lo, room), room > 0 ? 1.1 : 1.0);
    b = {b.lo / factor, b.hi * factor};
    if (b.hi / b.lo < 1.5) b = {b.lo / 2, b.hi * 2};
  } else {
    double span = std::max(b.hi - b.lo, axis.least);
    if (span <= 1e-9 * std::max(std::abs(b.lo), std::abs(b.hi)) || span == 0)
      span = std::max(0.1 * std::abs(b.lo), 1e-3);
    const double middle = 0.5 * (b.lo + b.hi);
    const double half = span * (0.5 + room);
    b = {middle - half, middle + half};
  }
  if (std::isnan(axis.lo)) axis.lo = b.lo;
  if (std::isnan(axis.hi)) axis.hi = b.hi;
}

}  // namespace

bool has_data(const Chart& chart) noexcept {
  for (const Panel& panel : chart.panels)
    for (const Line& line : panel.lines)
      for (const Point& p : line.points)
        if (std::isfinite(p.y)) return true;
  return false;
}

void fit_axes(std::span<Chart> charts) {
  std::size_t places = 0;
  for (const Chart& chart : charts) places = std::max(places, chart.panels.size());
  std::vector<Bounds> x(places), y(places);
  for (const Chart& chart : charts)
    for (std::size_t i = 0; i < chart.panels.size(); ++i) {
      const Panel& panel = chart.panels[i];
      x[chart.shared_x ? 0 : i].add(bounds(panel, &Point::x, panel.x.log));
      Bounds b = bounds(panel, &Point::y, panel.y.log);
      if (!b.empty()) reach_levels(b, panel);
      y[i].add(b);
    }
  constexpr double kRoom = 0.06;
  for (Chart& chart : charts)
    for (std::size_t i = 0; i < chart.panels.size(); ++i) {
      const bool path = chart.equal_aspect || chart.panels[i].x.log;
      set_open_ends(chart.panels[i].x, x[chart.shared_x ? 0 : i], path ? kRoom : 0);
      set_open_ends(chart.panels[i].y, y[i], kRoom);
    }
}

std::vector<Point> step_outline(std::span<const double> edges, std::span<const double> counts,
                                double floor) {
  std::vector<Point> out;
  const auto is_used = [](double c) { return c > 0; };
  const auto first = std::find_if(counts.begin(), counts.end(), is_used) - counts.begin();
  const auto last =
      counts.rend() - std::find_if(counts.rbegin(), counts.rend(), is_used);  // one past
  if (first >= last) return out;
  out.push_back({edges[static_cast<std::size_t>(first)], floor});
  for (auto i = static_cast<std::size_t>(first); i < static_cast<std::size_t>(last); ++i) {
    const double height = std::max(counts[i], floor);
    out.push_back({edges[i], height});
    out.push_back({edges[i + 1], height});
  }
  out.push_back({edges[static_cast<std::size_t>(last)], floor});
  return out;
}

}  // namespace farhand
