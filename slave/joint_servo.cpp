#include "slave/joint_servo.hpp"

#include <algorithm>
#include <cmath>
#include <numbers>

namespace farhand {
namespace {

constexpr double kSpeedShare = 0.95;      // of a joint's largest speed
constexpr double kFullSpeedAfter = 0.05;  // [s]
constexpr double kAtLimit = 0.002;        // [rad] that a joint at rest there is seen beyond it

}  // namespace

PidConfig joint_gains(const JointServoConfig& c, double inertia, double torque_limit) noexcept {
  const double w = 2 * std::numbers::pi * c.bandwidth_hz;
  const double kp = inertia * w * w;
  return {.kp = kp,
          .ki = c.integral_per_s * kp,
          .kd = 2 * c.damping_ratio * w * inertia,
          .limit = torque_limit,
          .derivative_cutoff_hz = c.derivative_cutoff_hz,
          .derivative_on_measurement = true};
}

std::complex<double> servo_error(const JointServoConfig& c, double w) noexcept {
  const PidConfig g = joint_gains(c, 1, std::numeric_limits<double>::infinity());
  const std::complex<double> s(0, w);
  const double fed = c.velocity_feedforward ? c.velocity_feedforward->share : 0;
  return (s * s + (1 - fed) * g.kd * s) / (s * s + g.kd * s + g.kp + g.ki / s);
}

JointServo::JointServo(const JointServoConfig& config, const ArmModel& model,
                       const JointLimits& joints, double Ts) noexcept
    : config_(config),
      model_(model),
      dynamics_(make_arm_dynamics(model)),
      joints_(joints),
      Ts_(Ts),
      rate_gain_(low_pass_gain(config.command_cutoff_hz, Ts)) {
  for (int i = 0; i < 6; ++i) {
    const PidConfig gains = joint_gains(config, config.inertia[i], model.links[i].torque_limit);
    pid_[i] = make_pid(gains, Ts);
    max_drive_[i] = gains.kd * kSpeedShare * joints.speed[i];
  }
  drive_step_ = max_drive_ * (Ts / kFullSpeedAfter);
}

void JointServo::reset() noexcept {
  state_ = {};
  primed_ = false;
  dq_cmd_.setZero();
  drive_.setZero();
  held_back_ = false;
}

bool JointServo::saturated() const noexcept {
  return std::any_of(state_.begin(), state_.end(), [](const PidState& s) { return s.saturated; });
}

const Vec6& JointServo::command_rate(const Vec6& q_cmd) noexcept {
  if (!primed_) q_cmd_ = q_cmd, primed_ = true;
  dq_cmd_ += rate_gain_ * ((q_cmd - q_cmd_) / Ts_ - dq_cmd_);
  q_cmd_ = q_cmd;
  return dq_cmd_;
}

void JointServo::turn_back(const Vec6& q) noexcept {
  if ((q - joints_.upper).cwiseMax(joints_.lower - q).maxCoeff() <= kAtLimit) return;
  for (int i = 0; i < 6; ++i) {
    PidState& s = state_[i];
    const bool above = q[i] > joints_.upper[i] + kAtLimit;
    const bool below = q[i] < joints_.lower[i] - kAtLimit;
    if ((above && s.I > 0) || (below && s.I < 0)) s.I = s.I_lost = 0;
  }
}

Vec6 JointServo::limited(const Vec6& drive) const noexcept {
  return drive.cwiseMax((drive_ - drive_step_).cwiseMax(-max_drive_))
      .cwiseMin((drive_ + drive_step_).cwiseMin(max_drive_));
}

Vec6 JointServo::step(const Vec6& q_cmd, const Vec6& q) noexcept {
  Vec6 ahead = Vec6::Zero(), drive;
  for (int i = 0; i < 6; ++i) drive[i] = pid_[i].kp * (q_cmd[i] - q[i]);
  if (config_.gravity_compensation) ahead = gravity_torques(dynamics_, q);
  if (config_.friction_compensation || config_.velocity_feedforward) {
    const Vec6& dq_cmd = command_rate(q_cmd);
    if (const auto& friction = config_.friction_compensation) {
      for (int i = 0; i < 6; ++i)
        ahead[i] += friction->share *
                    (model_.links[i].coulomb * std::tanh(dq_cmd[i] / friction->speed_scale) +
                     model_.links[i].viscous * dq_cmd[i]);
    }
    if (const auto& fed = config_.velocity_feedforward) {
      for (int i = 0; i < 6; ++i) {
        const double push = fed->share * pid_[i].kd_per_Ts * Ts_ * dq_cmd[i];
        ahead[i] += push;
        drive[i] += push;
      }
    }
  }
  drive_ = limited(drive);
  held_back_ = (drive.cwiseAbs() - max_drive_).maxCoeff() > 0;
  ahead -= drive - drive_;
  turn_back(q);
  Vec6 tau;
  for (int i = 0; i < 6; ++i) {
    PidState& s = state_[i];
    const double I = s.I, I_lost = s.I_lost;
    tau[i] = farhand::step(pid_[i], s, q_cmd[i], q[i], ahead[i]);
    if (drive[i] != drive_[i]) s.I = I, s.I_lost = I_lost;
  }
  return tau;
}

}  // namespace farhand
