// A recorded human motion made into a wish the hand can follow.
//
// The recording is averaged over 24 ms around the control points of a uniform cubic B-spline,
// played along a new time base and splined again: in all a zero-phase low-pass of 11 Hz (-3 dB), so
// human motion stays and the steps of the recording go. On the way it is centred, scaled into the
// reach, slowed down where it is too fast, and led in from the centre and back. A B-spline lies
// within its control points, and its velocity within their differences: reach, tilt and speed
// limits hold at every instant, not only at samples.
//
// Rotation is taken from the mean orientation about the axes of M and split into a tilt about x and
// y (a rotation vector without z) and a twist about z, each scaled; the tilt is cut at max_tilt.
#pragma once

#include <string>
#include <vector>

#include "common/geometry.hpp"
#include "master/recording.hpp"

namespace farhand {

struct TraceConfig {
  std::string file{};
  double scale = 0;             // motion times this; 0: the largest up to 1 that fits reach
  double reach = 0.035;         // [m] largest distance from the centre
  double rotation_scale = 0.5;  // share of the rotation, 0: none
  double max_tilt = 0.52359877559829887;  // [rad]
};

struct SpeedLimits {
  double speed = 0.5;                     // [m/s]
  double turn_rate = 2.0943951023931957;  // [rad/s], of tilt and twist together
};

// What became of the recording, for the log.
struct TraceReport {
  std::size_t rows = 0;
  double recorded = 0;      // [s]
  double duration = 0;      // [s], with slowing, leading in and out
  double largest_gap = 0;   // [s] between two rows
  double scale = 0;         // of the positions
  double slowed = 0;        // [s] of the recording that a limit slowed down
  double slowest_rate = 1;  // recorded seconds per second, where it is slowest
};

// Offset [m] and turn [rad] (tilt about x and y, twist) with their rates.
struct MotionSample {
  Vec3 p = Vec3::Zero();
  Vec3 v = Vec3::Zero();
  Vec3 turn = Vec3::Zero();
  Vec3 turn_rate = Vec3::Zero();
};

// 10 s^3 - 15 s^4 + 6 s^5 and its slope, s cut to [0, 1]; the slope is largest half way.
struct Progress {
  double x = 0;
  double rate = 0;
};
constexpr double kMinimumJerkPeak = 1.875;
constexpr Progress minimum_jerk(double s) noexcept {
  s = s < 0 ? 0 : s > 1 ? 1 : s;
  const double left = 1 - s;
  return {s * s * s * (10 + s * (6 * s - 15)), 30 * s * s * left * left};
}

class Trace {
 public:
  // Throws std::runtime_error with a sentence when the given scale does not fit the reach.
  Trace(const Recording& recording, const TraceConfig& config, const SpeedLimits& limits);

  // Twice continuously differentiable; at rest in the centre before 0 and after duration().
  MotionSample at(double t) const noexcept;
  double duration() const noexcept { return report_.duration; }
  const TraceReport& report() const noexcept { return report_; }

 private:
  std::vector<Vec6> control_;  // offset and turn, kControlStep apart
  TraceReport report_;
};

}  // namespace farhand
