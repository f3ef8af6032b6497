// What a chart shows, as plain values: panels in a grid, each with lines over two axes, and strips
// of states above them. svg_chart.hpp draws it.
#pragma once

#include <limits>
#include <span>
#include <string>
#include <vector>

#include "common/report/envelope.hpp"

namespace farhand {

// lo and hi left NaN are found by fit_axes().
struct Axis {
  std::string label;  // with the unit
  double lo = std::numeric_limits<double>::quiet_NaN();
  double hi = std::numeric_limits<double>::quiet_NaN();
  bool log = false;  // values that are not positive are not drawn
  double least = 0;  // smallest span, so that noise about a constant does not fill the panel
};

// Lines of one style look alike in all panels: a colour and a dash pattern, kLineStyles of them.
inline constexpr int kLineStyles = 6;
struct Line {
  std::string name;  // in the legend; lines of one name share an entry
  int style = 0;
  std::vector<Point> points;
  bool markers = false;  // a mark at each point, for measurements that are few
};

// Between lo and hi of the x axis.
struct Span {
  double lo = 0;
  double hi = 0;
  int shade = 0;  // 0..kShades-1
};
inline constexpr int kShades = 6;

// A row of spans over the common x axis.
struct Strip {
  std::string label;
  std::vector<Span> spans;
};

struct Panel {
  Axis x, y;
  std::vector<Line> lines;
  std::vector<double> levels;  // horizontal limit lines; seen where within the axis
  std::string note;            // in the upper right corner
};

struct Chart {
  std::string title;
  std::string subtitle;
  std::vector<Panel> panels;
  int columns = 1;       // of the grid of panels, filled row by row
  bool shared_x = true;  // all panels over the x axis of the first; else each has its own
  bool equal_aspect = false;
  std::string level_name;  // of all levels, in the legend
  std::vector<Strip> strips;
  std::vector<Span> shaded;  // behind the lines of every panel
  int width = 640;           // [px]
  int panel_height = 110;    // [px]
};

bool has_data(const Chart& chart) noexcept;

// Fills the open ends of all axes from the data with a little room, alike in all charts given:
// panels of one place get the same axes, so charts side by side can be compared. A level that the
// data reach half of is brought into view. Charts without data do not count.
void fit_axes(std::span<Chart> charts);

// Outline of a histogram: counts[i] lies between edges[i] and edges[i + 1]. Bins of zero are at
// `floor`, so that they can be drawn over a logarithmic axis.
std::vector<Point> step_outline(std::span<const double> edges, std::span<const double> counts,
                                double floor = 0.5);

}  // namespace farhand
