#include "common/report/chart_parts.hpp"
#include "common/report/statistics.hpp"

namespace farhand {
namespace {

// User's against environment's per axis, and the size of their difference.
Chart exchange(const RunView& view, std::string title, const char* unit, double scale, double least,
               const Columns<3> MasterData::*user, const Columns<3> MasterData::*environment,
               const char* symbols[2]) {
  const bool estimated = view.run.master && view.run.master->user_estimated;
  const std::string user_name = std::string(symbols[0]) + (estimated ? " (estimated)" : "");
  Chart c = time_chart(view, std::move(title));
  c.panel_height = 96;
  for (const char* axis : {"x", "y", "z", "error"})
    c.panels.push_back(time_panel(view, std::string(axis) + " [" + unit + "]", least));
  if (!view.run.master) return c;
  const MasterData& m = *view.run.master;
  for (std::size_t i = 0; i < 3; ++i) {
    c.panels[i].lines.push_back(line(view, m, (m.*user)[i], user_name, 0, scale));
    c.panels[i].lines.push_back(line(view, m, (m.*environment)[i], symbols[1], 1, scale));
  }
  c.panels[3].lines.push_back(
      line(view, m, distance(m.*user, m.*environment), "size of the difference", 3, scale));
  return c;
}

}  // namespace

Chart forces(const RunView& view) {
  static const char* symbols[2] = {"F_u, user on handle", "F_e, robot on environment"};
  return exchange(view, "Force of the user and of the environment (handle axes G)", "N", 1, 0.5,
                  &MasterData::user_force, &MasterData::environment_force, symbols);
}

Chart torques(const RunView& view) {
  static const char* symbols[2] = {"M_u, user on handle", "M_e, robot on environment"};
  return exchange(view, "Torque of the user and of the environment (handle axes G)", "mN m", 1e3,
                  10, &MasterData::user_torque, &MasterData::environment_torque, symbols);
}

Chart contact_force(const RunView& view) {
  Chart c = time_chart(view, "Size of the forces");
  Panel tool = time_panel(view, "at the tool [N]", 1),
        hand = time_panel(view, "on the hand [N]", 1);
  const auto add = [&](Panel& panel, const SideData& side, const Columns<3>& force,
                       const char* name, int style) {
    panel.lines.push_back(line(view, side, length(force), name, style, 1));
  };
  if (view.run.slave) {
    const SlaveData& s = *view.run.slave;
    add(tool, s, s.contact_force, "contact force", 1);
    if (recorded(s.boundary_force)) add(tool, s, s.boundary_force, "of the boundary", 2);
  }
  if (view.run.master) {
    const MasterData& m = *view.run.master;
    add(hand, m, m.force, "commanded", 0);
    if (recorded(m.coupling_force))
      add(hand, m, m.coupling_force, "of the coupling to the robot", 4);
  }
  if (view.limits && view.limits->max_force > 0) {
    hand.levels = {view.limits->max_force};
    c.level_name = "limit";
  }
  c.panels = {std::move(tool), std::move(hand)};
  c.panel_height = 140;
  return c;
}

Chart energy(const RunView& view) {
  Chart c = time_chart(view, "Energy at both ports");
  Panel ports = time_panel(view, "given out [mJ]", 1), sum = time_panel(view, "generated [mJ]", 1);
  const RunData& run = view.run;
  if (run.master)
    ports.lines.push_back(line(view, *run.master, run.master->work, "to the hand", 0, 1e3));
  if (run.slave)
    ports.lines.push_back(line(view, *run.slave, run.slave->work, "to the environment", 1, 1e3));
  if (run.master && run.slave)
    sum.lines.push_back(
        line(view, *run.slave, generated_energy(*run.master, *run.slave), "sum of both", 3, 1e3));
  c.panels = {std::move(ports), std::move(sum)};
  c.panel_height = 140;
  return c;
}

}  // namespace farhand
