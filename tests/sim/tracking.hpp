// Whether the robot follows as well as it can, in the quiet phase of an episode. It looks only
// where nothing holds the robot back: it has touched nothing for kRecovery, and the slave reports
// no limit and has had time to recover from those before.
//
// The command is where the newest message asks it to be: exactly, or with a compensation within the
// lag of its spring. The tool is where the command drives an ideal servo. All joints have the same
// gains but for their inertia, and so the same error transfer function (servo_error): the tool
// follows its path as a joint follows its angle, and one servo in three axes tells how. What a
// contact wound up in the joints' integrals, J diag(1/kp) J^T F at the tool, unwinds with their
// time constant and is allowed on top.
#pragma once

#include "common/pid.hpp"
#include "common/statistics.hpp"
#include "tests/loop/checkers.hpp"

namespace farhand {

// The joints' servo around its nominal inertia, without friction.
class IdealServo {
 public:
  IdealServo(const JointServoConfig& config, double Ts) noexcept;
  void start(const Vec3& r) noexcept;  // at rest
  Vec3 step(const Vec3& r) noexcept;   // where it is when it is told r

 private:
  PidConfig gains_;
  double Ts_, fed_, rate_gain_;
  Vec3 r_ = Vec3::Zero(), dr_ = Vec3::Zero();
  Vec3 x_ = Vec3::Zero(), dx_ = Vec3::Zero(), sum_ = Vec3::Zero();
};

class Tracking {
 public:
  static constexpr int kRecovery = 250;  // [ticks]: exp(-0.25 * 0.9 * 2 pi 6) = 2e-4
  // For each tick with a limit, up to that: noise runs into the joints' speed in single ones.
  static constexpr int kRecoveryPerTick = 10;
  struct Limits {
    double command = 1e-9;  // [m]
    double tool = 1e-3;     // [m]
  };

  Tracking(const Loopback& loop, Checkers& checkers, const Limits& limits) noexcept;

  // Every tick; judge: it must follow by now.
  void check(const SlaveTick& tick, bool judge);

  // Of the tool behind the handle at the same instant; of the command; of the tool from the ideal.
  const Rms& lag() const noexcept { return lag_; }
  const Rms& command() const noexcept { return command_; }
  const Rms& tool() const noexcept { return tool_; }

 private:
  void judge(const Vec3& p_cmd, const Vec3& p_ideal, const Vec3& p_SE);
  double wind_up(const SlaveTick& tick, const Wrench& F_E_S) const noexcept;

  const Loopback& loop_;
  Checkers& checkers_;
  Limits limits_;
  IdealServo ideal_;
  bool coupled_ = false;
  int held_ = 0;      // [ticks] until it has recovered from what held it back
  double wound_ = 0;  // [m]
  Rms lag_, command_, tool_;
};

}  // namespace farhand
