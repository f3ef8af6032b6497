// Drives the grip of a Falcon to set points: F = PID(r - p) + weight, one axis each (Falcon
// publication section on control, reference section 4). The torques follow by virtual work.
#pragma once

#include <array>
#include <vector>

#include "common/geometry.hpp"
#include "common/limits.hpp"
#include "common/pid.hpp"
#include "common/time.hpp"

namespace farhand {

struct SetPoint {
  Duration at{};  // since the first sample
  Vec3 p_MH = Vec3::Zero();
};

struct PositionControlConfig {
  PidConfig pid{.kp = 150, .ki = 13, .kd = 5};  // N/m, N/(m s), N s/m; limit is per axis
  double max_force = 8;                         // [N] on the sum
  double gravity_mass = 0.3;                    // [kg] whose weight is fed forward; 0: none
  Vec3 up_M = Vec3::UnitY();
  std::vector<SetPoint>
      set_points;  // ordered in time; before the first, the grip is held where it was at the start
};

class PositionControl {
 public:
  // Copies the set points: nothing is allocated later. Ts > 0 [s].
  PositionControl(const PositionControlConfig& config, double Ts);

  // Force of the grip on the hand in M [N].
  Vec3 step(TimePoint now, const Vec3& p_MH, LimitSet& set) noexcept;

  const Vec3& target() const noexcept { return target_; }

 private:
  PositionControlConfig config_;
  Pid pid_;
  std::array<PidState, 3> state_;
  bool started_ = false;
  TimePoint start_{};
  std::size_t next_ = 0;
  Vec3 target_ = Vec3::Zero();
};

}  // namespace farhand
