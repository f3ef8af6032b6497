// Drives the grip of a Falcon to set points: F = PID(r - p) + weight, one axis each (Falcon
// publication section on control, reference section 4). The torques follow by virtual work.
//
// As published, the target steps to the set point. With SafeMotion it travels there, and whatever
// the grip weighs, the motors never drive it faster than max_speed v:
//   F = clamp(PID, drive) - (drive / v) v_MH + weight,   drive = max_force - weight
// At v the motors' power on it is zero or less. A hand that holds the grip back or pushes it away
// feels at most max_force; meanwhile the target waits and the integral rests, so that, let go, the
// grip comes back at that speed without overshoot. Changes of the force are limited too.
#pragma once

#include <array>
#include <optional>
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

struct SafeMotion {
  double max_speed = 0.1;   // [m/s] > 0
  double force_step = 0.5;  // [N per tick]
};

// The set point shifts away from a danger, so that the hand feels where it is and how near
// (reference section 8).
struct DangerCueConfig {
  struct Scripted {
    Duration at{}, lasting{};
    Vec3 towards_M = Vec3::Zero();
  };
  double max_shift = 0.02;         // [m] at a danger of length 1
  double shift_step = 8e-5;        // [m per tick]
  std::vector<Scripted> script{};  // added to the danger given each tick
  double contact = 0;  // [N] of the robot's contact force at a danger of 1; 0: no danger
};

struct PositionControlConfig {
  PidConfig pid{.kp = 150, .ki = 13, .kd = 5};  // N/m, N/(m s), N s/m; limit is per axis
  double max_force = 8;                         // [N] on the sum
  double gravity_mass = 0.3;                    // [kg] whose weight is fed forward; 0: none
  Vec3 up_M = Vec3::UnitY();
  std::vector<SetPoint>
      set_points;  // ordered in time; before the first, the grip is held where it was at the start
  std::optional<SafeMotion> safe{};  // needs max_force above the weight
  std::optional<Vec3> park_p_MH{};   // where it goes while the clutch is held
  std::optional<DangerCueConfig> danger_cue{};
};

struct PositionInput {
  Vec3 p_MH = Vec3::Zero();
  Vec3 v_MH = Vec3::Zero();
  bool park = false;
  Vec3 danger_M = Vec3::Zero();  // towards a danger; length from 0, none, to 1, at its nearest
};

class PositionControl {
 public:
  // Copies the set points: nothing is allocated later. Ts > 0 [s].
  PositionControl(const PositionControlConfig& config, double Ts);

  // Force of the grip on the hand in M [N].
  Vec3 step(TimePoint now, const PositionInput& in, LimitSet& set) noexcept;

  // The motors gave nothing of the last force: in safe motion the next one comes up from zero.
  void let_go() noexcept { last_force_.setZero(); }

  // What the PID tracks: the point on the way, shifted by the cue.
  const Vec3& target() const noexcept { return target_; }

 private:
  Vec3 goal(TimePoint now, bool park) noexcept;
  void travel(const Vec3& goal, const Vec3& p_MH) noexcept;
  void shift(TimePoint now, const Vec3& danger_M) noexcept;
  Vec3 pid(const Vec3& p_MH, LimitSet& set) noexcept;
  Vec3 safe_force(const PositionInput& in, LimitSet& set) noexcept;

  PositionControlConfig config_;
  double Ts_;
  Pid pid_;
  Vec3 weight_;
  double drive_ = 0;  // [N] left for motion
  std::array<PidState, 3> state_;
  bool started_ = false;
  TimePoint start_{};
  std::size_t next_ = 0;
  Vec3 set_point_ = Vec3::Zero();
  Vec3 way_ = Vec3::Zero();  // the target without the cue
  Vec3 shift_ = Vec3::Zero();
  Vec3 target_ = Vec3::Zero();
  Vec3 last_force_ = Vec3::Zero();
};

}  // namespace farhand
