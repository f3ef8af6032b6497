#include "tests/sim/at_limit.hpp"

#include <algorithm>
#include <cmath>
#include <numbers>

#include "common/pid.hpp"

namespace farhand {
namespace {

bool apart(const Pose& a, const Pose& b) noexcept {
  constexpr double kSame = 1e-9;  // [m], [rad]
  return (a.p - b.p).norm() > kSame || rotation_vector(a.R * b.R.transpose()).norm() > kSame;
}

// As far in one tick as the workspace lets it.
bool at_speed(const WorkspaceConfig& c, const Pose& from, const Pose& to) noexcept {
  constexpr double kNearly = 0.999;
  return (to.p - from.p).norm() >= kNearly * c.position_step ||
         rotation_vector(to.R * from.R.transpose()).norm() >= kNearly * c.rotation_step;
}

// The command of a joint moves as fast as it may: at its speed, or braking for a joint limit that
// it comes to rest at (slave/slave.cpp).
bool moves_at_limit(const SlaveConfig& c, const Vec6& from, const Vec6& to) noexcept {
  constexpr double kNearly = 0.999;
  const double rate = 2 * std::numbers::pi * c.servo.bandwidth_hz / 3;
  for (int i = 0; i < 6; ++i) {
    const double left = to[i] > from[i] ? c.joints.upper[i] - from[i] : from[i] - c.joints.lower[i];
    const double most = c.Ts * std::min(c.joints.speed[i], rate * left);
    if (std::abs(to[i] - from[i]) >= kNearly * most) return true;
  }
  return false;
}

}  // namespace

bool AtLimit::step(const SlaveTick& t, const Vec6& q) noexcept {
  const SlaveConfig& c = loop_.slave()->config();
  bool held = off_target(t);
  if (last_) {
    dq_cmd_ += low_pass_gain(c.servo.command_cutoff_hz, c.Ts) *
               ((t.q_cmd - last_->q_cmd) / c.Ts - dq_cmd_);
    // A compensation's wish that cannot be reached leaves the target where it was.
    held = held || at_speed(c.workspace, last_->X_SE_target, t.X_SE_target) ||
           moves_at_limit(c, last_->q_cmd, t.q_cmd) ||
           (c.compensated && !apart(last_->X_SE_target, t.X_SE_target));
  } else {
    dq_cmd_.setZero();
  }
  last_ = {t.q_cmd, t.X_SE_target};
  return held || joints_at_limit(t, q);
}

bool AtLimit::off_target(const SlaveTick& t) const noexcept {
  const Slave& slave = *loop_.slave();
  const SlaveConfig& c = slave.config();
  const Pose X_cmd = forward(c.arm, t.q_cmd);
  if (c.compensated) return apart(X_cmd, t.X_SE_target);
  WorkspaceConfig unlimited = c.workspace;
  unlimited.position_step = unlimited.rotation_step = 1e9;
  const MasterToSlave& in = loop_.slave_end()->newest()->message;
  WorkspaceState workspace = slave.workspace();
  LimitSet unused = kLimitNone;
  return apart(X_cmd, follow(unlimited, workspace, {in.q_MH.toRotationMatrix(), in.p_MH}, unused));
}

// Within a tenth: what the servo reads is quantised, and its integral is not seen.
bool AtLimit::joints_at_limit(const SlaveTick& t, const Vec6& q) const noexcept {
  constexpr double kNear = 0.9;
  const SlaveConfig& c = loop_.slave()->config();
  if ((t.robot.dq.cwiseAbs() - c.joints.speed).maxCoeff() > 0) return true;
  const PidConfig gains = joint_gains(c.servo, 1, 1);
  const Vec6 asked = (dq_cmd_.cwiseAbs() + gains.kp / gains.kd * (t.q_cmd - q).cwiseAbs())
                         .cwiseQuotient(c.joints.speed);
  if (asked.maxCoeff() >= kNear) return true;
  for (int i = 0; i < 6; ++i)
    if (std::abs(t.tau[i]) >= kNear * c.model.links[i].torque_limit) return true;
  return false;
}

}  // namespace farhand
