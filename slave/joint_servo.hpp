// One PID per joint, with what the model knows fed forward (reference sections 4 and 9.3):
//
//   tau = PID(q_cmd - q) + G(q) + share C tanh(dq_cmd / speed) + share b dq_cmd + share kd dq_cmd
//         servo            gravity  Coulomb and viscous friction            velocity feed-forward
//
// kp = J w^2, kd = 2 z w J, ki = integral kp; derivative on the measurement; w = 2 pi bandwidth.
//
// kp (q_cmd - q) + share kd dq_cmd is kd times the speed at which the derivative stops the joint.
// It is held within kd times 95 % of the joint's largest speed (what the other joints' motion adds
// has the rest) and takes 50 ms from rest to there; meanwhile the integral rests. So a command that
// lags or turns round at full speed does not throw the joint beyond it, though the torque's own
// slew is slow against a light joint. Below nothing changes.
//
// A joint that stands beyond its limit loses what its integral pushes it further with: wound up by
// a fast motion's lag, it would hold it there against friction.
//
// Each feed-forward term is a stage of its own and costs nothing when it is absent. dq_cmd is the
// low-passed difference of q_cmd.
#pragma once

#include <array>
#include <complex>
#include <optional>

#include "common/geometry.hpp"
#include "common/pid.hpp"
#include "slave/arm.hpp"
#include "slave/arm_dynamics.hpp"

namespace farhand {

struct FrictionCompensationConfig {
  double share = 1;           // of the model's friction, 0..1
  double speed_scale = 0.02;  // [rad/s]
};
struct VelocityFeedforwardConfig {
  double share = 1;  // of kd, 0..1
};
struct JointServoConfig {
  double bandwidth_hz = 6;
  double damping_ratio = 0.9;
  double integral_per_s = 1;
  double derivative_cutoff_hz = 0;  // 0: none
  // Inertia each joint is tuned for [kg m^2], assumed (reference section 9.3).
  Vec6 inertia = (Vec6() << 0.5, 0.5, 0.3, 0.05, 0.05, 0.02).finished();
  double command_cutoff_hz = 12;  // of dq_cmd
  bool gravity_compensation = false;
  std::optional<FrictionCompensationConfig> friction_compensation;
  std::optional<VelocityFeedforwardConfig> velocity_feedforward;
};

PidConfig joint_gains(const JointServoConfig& config, double inertia, double torque_limit) noexcept;

// (r - q) / r at the angular frequency w [rad/s] of the servo as configured around a plant of its
// nominal inertia without friction: what tracking error to expect. Velocity feed-forward counts
// with its share.
std::complex<double> servo_error(const JointServoConfig& config, double w) noexcept;

class JointServo {
 public:
  // Ts > 0 [s]; the model gives gravity, friction and torque limits.
  JointServo(const JointServoConfig& config, const ArmModel& model, const JointLimits& joints,
             double Ts) noexcept;

  // Joint torques [N m], not yet limited. The first call after reset() starts without a kick.
  Vec6 step(const Vec6& q_cmd, const Vec6& q) noexcept;
  void reset() noexcept;
  // A controller's integral was stopped by the torque limit in the last step.
  bool saturated() const noexcept;
  // A joint's largest speed held its drive back in the last step: it follows later.
  bool held_back() const noexcept { return held_back_; }

 private:
  void turn_back(const Vec6& q) noexcept;
  const Vec6& command_rate(const Vec6& q_cmd) noexcept;
  Vec6 limited(const Vec6& drive) const noexcept;

  JointServoConfig config_;
  ArmModel model_;
  ArmDynamics dynamics_;
  JointLimits joints_;
  double Ts_;
  double rate_gain_;
  std::array<Pid, 6> pid_;
  Vec6 max_drive_;   // kd times the largest speed asked for [N m]
  Vec6 drive_step_;  // its largest change [N m per tick]
  Vec6 drive_ = Vec6::Zero();
  bool held_back_ = false;
  std::array<PidState, 6> state_;
  bool primed_ = false;
  Vec6 q_cmd_ = Vec6::Zero();
  Vec6 dq_cmd_ = Vec6::Zero();
};

}  // namespace farhand
