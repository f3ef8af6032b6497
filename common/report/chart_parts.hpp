// The pieces the report's charts are put together from.
#pragma once

#include <string>
#include <utility>
#include <vector>

#include "common/report/charts.hpp"

namespace farhand {

// The whole column over time, thinned to the chart's pixels; `scale` from SI to the axis' unit.
Line line(const RunView& view, const SideData& side, const Column& y, std::string name, int style,
          double scale);

// A chart over time with the run's strips and its contact shaded.
Chart time_chart(const RunView& view, std::string title);

// A panel over the view's time.
Panel time_panel(const RunView& view, std::string label, double least = 0);

// Columns of panels that a chart of this width has room for, at most `wanted`.
int panel_columns(const RunView& view, int wanted);

}  // namespace farhand
