// What of a run is drawn, chart by chart. Every chart of a kind has the same panels for every run,
// so that several runs can be put side by side; a chart without lines says "not recorded".
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "common/report/html_page.hpp"
#include "common/report/run_data.hpp"

namespace farhand {

// Limits that the recorded scene sets; none if it cannot be read.
struct RunLimits {
  double motor_torque = 0;  // of the handle [N m]
  double max_force = 0;     // on the hand [N]; 0 without force feedback
  double period_s = 0;
};
std::optional<RunLimits> limits_of(const RunData& run);

// The robot's, as its slave recorded them.
struct JointRanges {
  Vec6 q_lower, q_upper;  // [rad]
  Vec6 torque;            // [N m]
};
std::optional<JointRanges> joint_ranges(const RunData& run);

// A run as it is drawn: over which time, how wide, under which name.
struct RunView {
  const RunData& run;
  double t_end = 1;  // [s], of the common time axis
  int width = 640;   // [px], of a chart
  std::string name;  // empty if there is only one run
  std::optional<RunLimits> limits;
  std::optional<JointRanges> joints;
  std::vector<Strip> strips;
  std::vector<Span> contact;
};
std::vector<RunView> views(const std::vector<RunData>& runs, const std::vector<std::string>& names);

// HTML that explains the strips.
std::string strip_key();

// All rows of the report. A kind of chart that no run has data for is left out.
std::vector<ChartRow> chart_rows(const std::vector<RunView>& views);

// The kinds.
Chart handle_position(const RunView& view);
Chart robot_position(const RunView& view);
Chart tracking_error(const RunView& view);
Chart handle_turn(const RunView& view);
Chart robot_turn(const RunView& view);
Chart handle_path(const RunView& view);
Chart robot_path(const RunView& view);
Chart forces(const RunView& view);
Chart torques(const RunView& view);
Chart contact_force(const RunView& view);
Chart joint_angles(const RunView& view);
Chart joint_torques(const RunView& view);
Chart motor_torques(const RunView& view);
Chart energy(const RunView& view);
Chart ages(const RunView& view);
Chart busy_times(const RunView& view);
Chart stage_histograms(const RunView& view);

}  // namespace farhand
