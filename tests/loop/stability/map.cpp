#include "tests/loop/stability/map.hpp"

#include <spdlog/fmt/fmt.h>

#include <algorithm>
#include <cmath>

#include "tests/loop/stability/simulated.hpp"

namespace farhand {
namespace {

constexpr int kPredicted = 25, kSimulated = 5;  // points of each
constexpr double kDelay = 0.005;                // [s], the middle of the round trips
constexpr double kTo = 10;                      // times the middle, each way
constexpr const char* kStiffness = "largest stable wall [N/m]";

std::string label(Parameter p) {
  const ParameterText words = text(p);
  return words.unit[0] != '\0' ? fmt::format("{} [{}]", words.name, words.unit) : words.name;
}

double predicted_stiffness(const Scene& scene, int surface) {
  const double k = predicted_limit(scene, surface, Parameter::wall_stiffness).value;
  return std::isfinite(k) ? k : 0;  // neither 0 is drawn on a logarithmic axis
}

Panel panel_over(const Scene& scene, int surface, Parameter p) {
  const double unit = text(p).per_unit, own = get(scene, surface, p);
  const double middle = p == Parameter::round_trip ? kDelay : own;
  Panel panel{.x = {.label = label(p), .log = true}, .y = {.label = kStiffness, .log = true}};
  Line predicted{.name = "predicted"};
  Line simulated{.name = "simulated with the product's loop", .style = 1, .markers = true};
  const int each = (kPredicted - 1) / (kSimulated - 1);
  for (int i = 0; i < kPredicted; ++i) {
    const double x = middle * std::pow(kTo, 2.0 * i / (kPredicted - 1) - 1);
    const Scene varied = with(scene, surface, p, x);
    const double k = predicted_stiffness(varied, surface);
    predicted.points.push_back({x * unit, k});
    if (i % each == 0 && k > 0)
      simulated.points.push_back(
          {x * unit, simulated_limit(varied, surface, Parameter::wall_stiffness, k)});
  }
  const Line here{.name = "the scene",
                  .style = 3,
                  .points = {{own * unit, get(scene, surface, Parameter::wall_stiffness)}},
                  .markers = true};
  panel.lines = {predicted, simulated, here};
  return panel;
}

}  // namespace

Chart stability_map(const Scene& scene, int surface) {
  Chart chart{.title = fmt::format("Stability of {}, surface[{}]", scene.path, surface),
              .subtitle = "stable below the line; linear: no friction, bilateral wall",
              .columns = 3,
              .shared_x = false,
              .width = 1100,
              .panel_height = 260};
  for (const Parameter p :
       {Parameter::round_trip, Parameter::reflection_gain, Parameter::device_mass})
    chart.panels.push_back(panel_over(scene, surface, p));
  return chart;
}

Chart grid_map(const std::vector<GridPoint>& points) {
  Chart chart{
      .title = "Largest stable wall, predicted and simulated",
      .subtitle = "stable below; lines as predicted, marks as found with the product's loop",
      .columns = 3,
      .width = 1100,
      .panel_height = 230};
  std::string note;
  for (const GridPoint& p : points) {
    if (p.parameter != Parameter::wall_stiffness || !p.compared()) continue;
    const std::string here =
        fmt::format("device {:g} kg, hand {:g} kg", p.device_mass, p.hand_mass);
    if (here != note || chart.panels.empty()) {
      note = here;
      chart.panels.push_back({.x = {.label = label(Parameter::round_trip), .log = true},
                              .y = {.label = kStiffness, .log = true},
                              .note = note});
    }
    const std::string name = p.variant();
    auto& lines = chart.panels.back().lines;
    auto line =
        std::find_if(lines.begin(), lines.end(), [&](const Line& l) { return l.name == name; });
    if (line == lines.end()) {
      const int style = static_cast<int>(lines.size() / 2);
      lines.push_back({.name = name, .style = style});
      lines.push_back({.style = style, .markers = true});
      line = lines.end() - 2;
    }
    line->points.push_back({p.round_trip * 1e3, p.predicted});
    (line + 1)->points.push_back({p.round_trip * 1e3, p.simulated});
  }
  return chart;
}

}  // namespace farhand
