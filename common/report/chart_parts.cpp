#include "common/report/chart_parts.hpp"

#include <algorithm>
#include <cmath>
#include <functional>

#include "common/mode.hpp"
#include "common/report/statistics.hpp"
#include "common/statistics.hpp"

namespace farhand {
namespace {

// Where `where` holds, as spans; nearer ones than `gap` [s] become one.
std::vector<Span> spans(const std::vector<double>& t, double gap, int shade,
                        const std::function<bool(std::size_t)>& where) {
  std::vector<Span> out;
  for (std::size_t i = 0; i < t.size(); ++i) {
    if (!where(i)) continue;
    const double end = i + 1 < t.size() ? t[i + 1] : t[i];
    if (!out.empty() && t[i] - out.back().hi <= gap)
      out.back().hi = end;
    else
      out.push_back({t[i], end, shade});
  }
  return out;
}

std::vector<Span> contact(const RunData& run, double gap) {
  if (!run.slave && !run.master) return {};
  const Columns<3>& force = run.slave ? run.slave->contact_force : run.master->environment_force;
  const Column size = length(force);
  const std::vector<double>& t = run.slave ? run.slave->t : run.master->t;
  return spans(t, gap, 4, [&](std::size_t i) { return size[i] > kContactForce; });
}

std::vector<Strip> strips(const RunView& view, double gap) {
  const RunData& run = view.run;
  const SideData* side =
      run.master ? static_cast<const SideData*>(&*run.master) : (run.slave ? &*run.slave : nullptr);
  if (side == nullptr) return {};
  Strip modes{"state", {}};
  for (const Mode mode : {Mode::ready, Mode::engaged, Mode::holding, Mode::aligning, Mode::fault}) {
    const auto m = static_cast<std::uint8_t>(mode);
    const std::vector<Span> s =
        spans(side->t, 0, m - 1, [&](std::size_t i) { return side->mode[i] == m; });
    modes.spans.insert(modes.spans.end(), s.begin(), s.end());
  }
  const SideData& coupled = run.slave ? static_cast<const SideData&>(*run.slave) : *side;
  return {std::move(modes),
          {"coupled", spans(coupled.t, gap, 3, [&](std::size_t i) { return coupled.coupled[i]; })},
          {"contact", view.contact},
          {"limits", spans(side->t, gap, 5, [&](std::size_t i) { return side->limits[i] != 0; })}};
}

}  // namespace

std::vector<RunView> views(const std::vector<RunData>& runs,
                           const std::vector<std::string>& names) {
  double t_end = 0;
  for (const RunData& run : runs) t_end = std::max(t_end, run.duration());
  t_end = std::ceil(t_end * 100) / 100;  // 20 s, not 19.999
  std::vector<RunView> out;
  for (std::size_t i = 0; i < runs.size(); ++i) {
    const int width = runs.size() <= 2 ? 640 : (runs.size() == 3 ? 440 : 330);
    RunView view{runs[i], t_end > 0 ? t_end : 1, width, runs.size() > 1 ? names[i] : ""};
    const double pixel = view.t_end / width;
    view.limits = limits_of(runs[i]);
    view.joints = joint_ranges(runs[i]);
    view.contact = contact(runs[i], pixel);
    view.strips = strips(view, pixel);
    out.push_back(std::move(view));
  }
  return out;
}

std::string strip_key() {
  static constexpr const char* kNames[kShades] = {
      "ready",        "engaged", "holding", "coupled", "in contact (over 0.5 N), also shaded below",
      "a limit acted"};
  std::string out = "<div class=\"key\"><span>Strips above the charts:</span>";
  for (int shade = 0; shade < kShades; ++shade)
    out += "<span><svg viewBox=\"0 0 22 10\"><path class=\"s" + std::to_string(shade) +
           "\" d=\"M0 1h22v8h-22z\"/></svg>" + kNames[shade] + "</span>";
  return out + "</div>\n";
}

Line line(const RunView& view, const SideData& side, const Column& y, std::string name, int style,
          double scale) {
  return {std::move(name), style, envelope(side.t, y, 0, view.t_end, view.width, scale)};
}

Chart time_chart(const RunView& view, std::string title) {
  Chart c{.title = std::move(title), .subtitle = view.name};
  c.strips = view.strips;
  c.shaded = view.contact;
  c.width = view.width;
  return c;
}

Panel time_panel(const RunView& view, std::string label, double least) {
  Panel p;
  p.x = {.label = "time [s]", .lo = 0, .hi = view.t_end};
  p.y = {.label = std::move(label), .least = least};
  return p;
}

int panel_columns(const RunView& view, int wanted) {
  return std::clamp(view.width / 200, 1, wanted);
}

}  // namespace farhand
