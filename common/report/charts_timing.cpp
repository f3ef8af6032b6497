#include <algorithm>
#include <cmath>

#include "common/report/chart_parts.hpp"

namespace farhand {
namespace {

// Ten bins per decade from 0.1 us to 1 s.
constexpr int kPerDecade = 10, kDecades = 7;
constexpr double kFirst = 0.1;

const std::vector<double>& bin_edges() {
  static const std::vector<double> edges = [] {
    std::vector<double> e;
    for (int i = 0; i <= kPerDecade * kDecades; ++i)
      e.push_back(kFirst * std::pow(10.0, static_cast<double>(i) / kPerDecade));
    return e;
  }();
  return edges;
}

std::vector<double> histogram(const Column& us) {
  std::vector<double> counts(bin_edges().size() - 1, 0);
  for (const float t : us) {
    if (!std::isfinite(t)) continue;
    const double bin = std::floor(std::log10(t / kFirst) * kPerDecade);
    const double last = static_cast<double>(counts.size() - 1);
    ++counts[static_cast<std::size_t>(std::clamp(bin, 0.0, last))];
  }
  return counts;
}

Panel histogram_panel(const char* side_name, const SideData* side) {
  Panel p;
  p.x = {.label = "time [\u00b5s]", .log = true};
  p.y = {.label = std::string(side_name) + ": ticks", .log = true};
  for (std::size_t i = 0; side != nullptr && i < kStageNames.size(); ++i)
    p.lines.push_back({kStageNames[i], static_cast<int>(i),
                       step_outline(bin_edges(), histogram(side->stages[i]))});
  return p;
}

Panel log_panel(const RunView& view, std::string label) {
  Panel p = time_panel(view, std::move(label));
  p.y.log = true;
  return p;
}

}  // namespace

Chart ages(const RunView& view) {
  Chart c = time_chart(view, "Age of the data and round trip");
  Panel age = log_panel(view, "age [ms]"), trip = log_panel(view, "round trip [ms]");
  if (view.run.master) {
    const MasterData& m = *view.run.master;
    age.lines.push_back(line(view, m, m.age, "slave's message at the master", 0, 1e3));
    trip.lines.push_back(line(view, m, m.round_trip, "round trip", 3, 1e-3));
  }
  if (view.run.slave) {
    const SlaveData& s = *view.run.slave;
    age.lines.push_back(line(view, s, s.age, "master's message at the slave", 1, 1e3));
  }
  c.panels = {std::move(age), std::move(trip)};
  c.panel_height = 140;
  return c;
}

Chart busy_times(const RunView& view) {
  Chart c = time_chart(view, "Time a tick is busy");
  Panel master = log_panel(view, "master [\u00b5s]"), slave = log_panel(view, "slave [\u00b5s]");
  const auto add = [&](Panel& p, const SideData& side) {
    p.lines.push_back(line(view, side, side.busy, "busy", 0, 1));
    if (view.limits) p.levels = {view.limits->period_s * 1e6};
  };
  if (view.run.master) add(master, *view.run.master);
  if (view.run.slave) add(slave, *view.run.slave);
  c.level_name = "period";
  c.panels = {std::move(master), std::move(slave)};
  c.panel_height = 140;
  return c;
}

Chart stage_histograms(const RunView& view) {
  Chart c{.title = "Tick time by stage", .subtitle = view.name};
  c.width = view.width;
  c.panel_height = 150;
  c.panels = {histogram_panel("master", view.run.master ? &*view.run.master : nullptr),
              histogram_panel("slave", view.run.slave ? &*view.run.slave : nullptr)};
  return c;
}

}  // namespace farhand
