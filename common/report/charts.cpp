#include "common/report/charts.hpp"

#include <algorithm>
#include <sstream>

#include "common/scene.hpp"

namespace farhand {
namespace {

struct Kind {
  const char* heading;  // of the row this kind begins; nullptr: it joins the row before
  const char* explanation;
  Chart (*draw)(const RunView&);
};

constexpr Kind kKinds[] = {
    {"Position", "Handle in the master's frame M, tool in the robot's frame S.", handle_position},
    {nullptr, nullptr, robot_position},
    {"Orientation",
     "Rotation vector from the first tick's orientation, so a turn about one axis is one line.",
     handle_turn},
    {nullptr, nullptr, robot_turn},
    {"Path", "Projections with equal scales.", handle_path},
    {nullptr, nullptr, robot_path},
    {"Tracking", "Tool against its target, as the slave knew both at the same tick.",
     tracking_error},
    {nullptr, nullptr, contact_force},
    {"Force exchange",
     "What the user does to the handle against what the robot does to the environment, in the "
     "handle's axes; equal where the teleoperation is transparent.",
     forces},
    {nullptr, nullptr, torques},
    {"Joints", "Commands and measured angles; torques as written, limits where they come near.",
     joint_angles},
    {nullptr, nullptr, joint_torques},
    {"Handle's motors and energy",
     "Energy: motor torques times motor angles, and contact wrench times tool velocity. Both "
     "count what is given out; a positive sum at the end was generated in between.",
     motor_torques},
    {nullptr, nullptr, energy},
    {"Link and timing", "Logarithmic, since a late datum is late by orders of magnitude.", ages},
    {nullptr, nullptr, busy_times},
    {nullptr, nullptr, stage_histograms},
};

std::vector<Chart> draw_all(const Kind& kind, const std::vector<RunView>& views) {
  std::vector<Chart> charts;
  for (const RunView& view : views) charts.push_back(kind.draw(view));
  if (std::none_of(charts.begin(), charts.end(), has_data)) return {};
  fit_axes(charts);
  return charts;
}

bool read_numbers(const std::map<std::string, std::string>& from, const char* key, Vec6& to) {
  const auto text = from.find(key);
  if (text == from.end()) return false;
  std::istringstream in(text->second);
  for (double& x : to) in >> x;
  return !in.fail();
}

}  // namespace

std::optional<RunLimits> limits_of(const RunData& run) {
  if (run.scene_text.empty()) return std::nullopt;
  try {
    const proto::Scene scene = parse_scene(run.scene_text, run.scene_path).proto;
    RunLimits limits;
    const proto::Master& master = scene.master();
    limits.motor_torque = master.has_falcon() ? master.falcon().max_motor_torque_newton_meter()
                                              : master.twin_delta().max_motor_torque_newton_meter();
    if (master.has_force_feedback()) limits.max_force = master.force_feedback().max_force_newton();
    limits.period_s = 1 / scene.rate_hz();
    return limits;
  } catch (const SceneError&) {
    return std::nullopt;  // of another version: the charts do without
  }
}

std::optional<JointRanges> joint_ranges(const RunData& run) {
  const auto robot = run.metadata.find("robot");
  if (robot == run.metadata.end()) return std::nullopt;  // the slave's file is not here
  JointRanges out;
  const bool whole = read_numbers(robot->second, "q_lower_rad", out.q_lower) &&
                     read_numbers(robot->second, "q_upper_rad", out.q_upper) &&
                     read_numbers(robot->second, "joint_torque_nm", out.torque);
  return whole ? std::optional(out) : std::nullopt;
}

std::vector<ChartRow> chart_rows(const std::vector<RunView>& views) {
  std::vector<ChartRow> rows;
  for (const Kind& kind : kKinds) {
    if (kind.heading != nullptr) rows.push_back({kind.heading, kind.explanation, {}});
    for (Chart& chart : draw_all(kind, views)) rows.back().charts.push_back(std::move(chart));
  }
  std::erase_if(rows, [](const ChartRow& row) { return row.charts.empty(); });
  return rows;
}

}  // namespace farhand
