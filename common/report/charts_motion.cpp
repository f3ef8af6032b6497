#include <algorithm>
#include <cmath>
#include <numbers>

#include "common/report/chart_parts.hpp"
#include "common/report/statistics.hpp"
#include "common/report/text.hpp"

namespace farhand {
namespace {

constexpr double kMilli = 1e3;
constexpr double kDegrees = 180 / std::numbers::pi;
constexpr double kLeastMm = 2, kLeastDeg = 1;  // spans of an axis at rest
constexpr const char* kAxes[] = {"x", "y", "z"};

// Three panels of one vector over time, and of a second, what it should be.
Chart vector_chart(const RunView& view, std::string title, const SideData* side,
                   const Columns<3>* actual, const char* actual_name, const Columns<3>* wanted,
                   const char* unit, double scale, double least) {
  Chart c = time_chart(view, std::move(title));
  for (std::size_t i = 0; i < 3; ++i) {
    Panel p = time_panel(view, std::string(kAxes[i]) + " [" + unit + "]", least);
    if (side != nullptr) p.lines.push_back(line(view, *side, (*actual)[i], actual_name, 0, scale));
    if (side != nullptr && wanted != nullptr)
      p.lines.push_back(line(view, *side, (*wanted)[i], "target", 1, scale));
    c.panels.push_back(std::move(p));
  }
  return c;
}

struct Plane {
  std::size_t x, y;
};

// Projections of one path, and of a second; equal scales.
Chart path_chart(const RunView& view, std::string title, const Columns<3>* actual, const char* name,
                 const Columns<3>* wanted) {
  Chart c{.title = std::move(title), .subtitle = view.name};
  c.columns = panel_columns(view, 3);
  c.shared_x = false;
  c.equal_aspect = true;
  c.width = view.width;
  c.panel_height = c.columns == 3 ? 170 : 150;
  constexpr int kCells = 400;  // more than it has pixels
  for (const Plane plane : {Plane{0, 1}, Plane{0, 2}, Plane{1, 2}}) {
    Panel p;
    p.x = {.label = std::string(kAxes[plane.x]) + " [mm]", .least = kLeastMm};
    p.y = {.label = std::string(kAxes[plane.y]) + " [mm]", .least = kLeastMm};
    const auto add = [&](const Columns<3>* path, const char* path_name, int style) {
      if (path == nullptr) return;
      p.lines.push_back(
          {path_name, style, thin_path((*path)[plane.x], (*path)[plane.y], kCells, kMilli)});
    };
    add(actual, name, 0);
    add(wanted, "target", 1);
    c.panels.push_back(std::move(p));
  }
  return c;
}

// Of all joints or motors: command, actual and limits.
struct JointLines {
  const Columns<6>* column;
  const char* name;
  int style;
};
Chart joint_chart(const RunView& view, std::string title, const char* symbol, const char* unit,
                  const SideData* side, const std::vector<JointLines>& lines, double scale,
                  double least) {
  Chart c = time_chart(view, std::move(title));
  c.columns = panel_columns(view, 2);
  c.panel_height = 84;
  c.level_name = "limit";
  c.strips.clear();  // they would stand above the first column only
  for (std::size_t i = 0; i < 6; ++i) {
    Panel p = time_panel(view, symbol + std::to_string(i + 1) + " [" + unit + "]", least);
    for (const JointLines& l : lines)
      if (side != nullptr)
        p.lines.push_back(line(view, *side, (*l.column)[i], l.name, l.style, scale));
    c.panels.push_back(std::move(p));
  }
  return c;
}

double largest(const Panel& panel) {
  double peak = 0;
  for (const Line& l : panel.lines)
    for (const Point& p : l.points)
      if (std::isfinite(p.y)) peak = std::max(peak, std::abs(p.y));
  return peak;
}

void add_torque_limit(Panel& panel, double limit) {
  panel.levels = {-limit, limit};
  panel.note = "peak " + figure(largest(panel)) + ", limit " + figure(limit);
}

}  // namespace

Chart handle_position(const RunView& view) {
  const MasterData* m = view.run.master ? &*view.run.master : nullptr;
  return vector_chart(view, "Handle position (frame M)", m, m ? &m->position : nullptr, "handle",
                      m && m->position_controlled ? &m->target : nullptr, "mm", kMilli, kLeastMm);
}

Chart robot_position(const RunView& view) {
  const SlaveData* s = view.run.slave ? &*view.run.slave : nullptr;
  return vector_chart(view, "Robot position (frame S)", s, s ? &s->position : nullptr, "robot",
                      s ? &s->target : nullptr, "mm", kMilli, kLeastMm);
}

Chart handle_turn(const RunView& view) {
  const MasterData* m = view.run.master ? &*view.run.master : nullptr;
  return vector_chart(view, "Handle orientation, turn since the start (frame M)", m,
                      m ? &m->turn : nullptr, "handle", nullptr, "deg", kDegrees, kLeastDeg);
}

Chart robot_turn(const RunView& view) {
  const SlaveData* s = view.run.slave ? &*view.run.slave : nullptr;
  return vector_chart(view, "Robot orientation, turn since the start (frame S)", s,
                      s ? &s->turn : nullptr, "robot", s ? &s->target_turn : nullptr, "deg",
                      kDegrees, kLeastDeg);
}

Chart tracking_error(const RunView& view) {
  Chart c = time_chart(view, "Tracking error while coupled");
  Panel position = time_panel(view, "position [mm]", 0.1);
  Panel rotation = time_panel(view, "rotation [mrad]", 0.1);
  if (view.run.slave) {
    const SlaveData& s = *view.run.slave;
    position.lines.push_back(line(view, s, s.position_error, "", 0, kMilli));
    rotation.lines.push_back(line(view, s, s.rotation_error, "", 0, kMilli));
  }
  c.panels = {std::move(position), std::move(rotation)};
  c.panel_height = 140;
  return c;
}

Chart handle_path(const RunView& view) {
  const MasterData* m = view.run.master ? &*view.run.master : nullptr;
  return path_chart(view, "Path of the handle (frame M)", m ? &m->position : nullptr, "handle",
                    nullptr);
}

Chart robot_path(const RunView& view) {
  const SlaveData* s = view.run.slave ? &*view.run.slave : nullptr;
  return path_chart(view, "Path of the tool (frame S)", s ? &s->position : nullptr, "robot",
                    s ? &s->target : nullptr);
}

Chart joint_angles(const RunView& view) {
  const SlaveData* s = view.run.slave ? &*view.run.slave : nullptr;
  std::vector<JointLines> lines;
  if (s) lines = {{&s->q, "joint", 0}, {&s->q_command, "command", 1}};
  Chart c = joint_chart(view, "Joint angles", "q", "deg", s, lines, kDegrees, kLeastDeg);
  for (int i = 0; view.joints && i < 6; ++i)
    c.panels[static_cast<std::size_t>(i)].levels = {view.joints->q_lower[i] * kDegrees,
                                                    view.joints->q_upper[i] * kDegrees};
  return c;
}

Chart joint_torques(const RunView& view) {
  const SlaveData* s = view.run.slave ? &*view.run.slave : nullptr;
  std::vector<JointLines> lines;
  if (s) lines = {{&s->tau, "commanded", 0}};
  Chart c = joint_chart(view, "Joint torques", "\u03c4", "N m", s, lines, 1, 0.1);
  for (int i = 0; view.joints && i < 6; ++i)
    add_torque_limit(c.panels[static_cast<std::size_t>(i)], view.joints->torque[i]);
  return c;
}

Chart motor_torques(const RunView& view) {
  const MasterData* m = view.run.master ? &*view.run.master : nullptr;
  std::vector<JointLines> lines;
  if (m) lines = {{&m->tau, "commanded", 0}};
  Chart c = joint_chart(view, "Motor torques of the handle", "\u03c4", "N m", m, lines, 1, 0.05);
  std::erase_if(c.panels, [](const Panel& p) {  // a Falcon has three
    return std::all_of(p.lines.begin(), p.lines.end(),
                       [](const Line& l) { return l.points.empty(); }) &&
           !p.lines.empty();
  });
  for (Panel& p : c.panels)
    if (view.limits) add_torque_limit(p, view.limits->motor_torque);
  return c;
}

}  // namespace farhand
