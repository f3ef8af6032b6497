// Whether the robot follows as well as it can, in the quiet phase of an episode. It looks only
// where nothing holds the robot back: it has touched nothing for kRecovery, and the slave reports
// no limit and has had time to recover from those before.
//
// The command is where the newest message asks it to be, and in a gap where its velocity leads
// (common/concealment.hpp): exactly, or with a compensation within the lag of its spring. The tool
// is where the command drives an ideal servo. All joints have the same gains but for their inertia,
// and so the same error transfer function (servo_error): the tool follows its path as a joint
// follows its angle, and one servo in three axes tells how. What a contact wound up in the joints'
// integrals, J diag(1/kp) J^T F at the tool, unwinds with their time constant and is allowed on
// top. From the hand to the tool all that adds up, with what the hand has moved since it gave the
// newest order.
//
// Where the slave reports a limit there must be one (tests/sim/at_limit.hpp): so nothing can hide
// behind it.
#pragma once

#include <array>
#include <optional>
#include <vector>

#include "common/pid.hpp"
#include "common/statistics.hpp"
#include "tests/loop/checkers.hpp"
#include "tests/sim/at_limit.hpp"

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
  static constexpr int kFree = 2 * kRecovery;  // [ticks]: the tool leaves the wall, and recovers
  struct Limits {
    double command = 1e-9;  // [m]
    double tool = 1e-3;     // [m]
    double handle = 1e-4;   // [m] as measured from where it truly is
    int played_out = 0;     // [ticks] that what is asked for may have been asked before
    // What the hand moved before it was heard stays between it and the tool, as by waves.
    bool keeps_offset = false;
  };
  // What there is to touch: a point of its surface and the direction to its free side.
  struct Wall {
    Vec3 point, normal;
  };

  Tracking(const Loopback& loop, Checkers& checkers, const Limits& limits,
           const std::optional<Wall>& wall) noexcept;

  // Just before the master's sample is sent.
  void sampling() noexcept;
  // Every tick; judge: it must follow by now.
  void check(const SlaveTick& tick, bool judge);

  // [ticks] of those to be judged: that were, that a limit kept from it, and that the hand, or the
  // command where an offset is kept, had been free of the wall for kFree.
  long judged() const noexcept { return judged_; }
  long limited() const noexcept { return limited_; }
  long free() const noexcept { return free_; }
  // Of the tool behind the handle at the same instant; of the command, beyond what is played out;
  // of the tool from the ideal, beyond what was wound up.
  const Rms& lag() const noexcept { return lag_; }
  const Rms& command() const noexcept { return command_; }
  const Rms& tool() const noexcept { return tool_; }

 private:
  struct Places {
    Vec3 p_cmd, p_ideal, p_SE;
    Vec3 asked;         // by the newest message, and where it leads on to in a gap,
    double led_on = 0;  // by so much [m]
  };
  void start(const Places& at) noexcept;
  void judge(const Places& at);
  bool clear(const Places& at) const noexcept;
  double moved_lately() const noexcept;
  void drift(const Places& at, bool held) noexcept;
  void weigh(const SlaveTick& tick, const Vec6& q) noexcept;
  double wind_up(const SlaveTick& tick, const Wrench& F_E_S) const noexcept;
  double displaced(const ArmJacobian& J, const Vec6& tau) const noexcept;

  const Loopback& loop_;
  Checkers& checkers_;
  Limits limits_;
  AtLimit at_limit_;
  IdealServo ideal_;
  ArmDynamics dynamics_;
  double held_off_ = 0;  // the command, by a guard that lets it come back slowly [m]
  bool coupled_ = false;
  int touched_ = 0, held_ = 0;   // [ticks] until it has recovered from contact, from limits
  double wound_ = 0;             // [m]
  Vec6 carried_ = Vec6::Zero();  // of the weight, by integrals [N m], where nothing else carries it
  double sagged_ = 0;            // by what they do not [m]
  std::optional<Wall> wall_;
  int clear_ = 0;  // [ticks] of the wall
  // Where the command is kept off from what is asked for, and what was to be played out then.
  struct Offset {
    Vec3 by;
    double slack = 0;
  };
  std::optional<Offset> offset_;
  std::vector<Vec3> asked_;  // in the last ticks, a ring
  std::size_t next_ = 0;
  long judged_ = 0, limited_ = 0, free_ = 0;
  std::array<Vec3, 4096> given_{};  // where the handle was for each order, by its number
  Rms lag_, command_, tool_;
};

}  // namespace farhand
