// Draws a chart as SVG: no script, no reference to anything outside.
#pragma once

#include <string>

#include "common/report/chart.hpp"

namespace farhand {

// For a page that contains chart_style(). All axes must be fitted (fit_axes); equal_aspect widens
// the shorter axis of each panel. All texts are escaped here.
std::string svg(const Chart& chart);

// A file of its own, with its style: fits the axes, too.
std::string standalone_svg(Chart chart);

}  // namespace farhand
