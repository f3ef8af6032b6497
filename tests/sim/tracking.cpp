#include "tests/sim/tracking.hpp"

#include <algorithm>
#include <limits>

#include "tests/loop/truth.hpp"

namespace farhand {

IdealServo::IdealServo(const JointServoConfig& c, double Ts) noexcept
    : gains_(joint_gains(c, 1, std::numeric_limits<double>::infinity())),
      Ts_(Ts),
      fed_(c.velocity_feedforward ? c.velocity_feedforward->share : 0),
      rate_gain_(low_pass_gain(c.command_cutoff_hz, Ts)) {}

void IdealServo::start(const Vec3& r) noexcept {
  r_ = x_ = r;
  dr_ = dx_ = sum_ = Vec3::Zero();
}

Vec3 IdealServo::step(const Vec3& r) noexcept {
  const Vec3 x = x_;
  dr_ += rate_gain_ * ((r - r_) / Ts_ - dr_);
  r_ = r;
  sum_ += Ts_ * (r - x_);
  dx_ += Ts_ * (gains_.kp * (r - x_) + gains_.ki * sum_ + gains_.kd * (fed_ * dr_ - dx_));
  x_ += Ts_ * dx_;
  return x;
}

Tracking::Tracking(const Loopback& loop, Checkers& checkers, const Limits& limits) noexcept
    : loop_(loop),
      checkers_(checkers),
      limits_(limits),
      ideal_(loop.slave()->config().servo, loop.slave()->config().Ts) {}

void Tracking::check(const SlaveTick& t, bool judged) {
  constexpr LimitSet kHeldBack = kLimitWorkspace | kLimitSpeed | kLimitForce | kLimitSaturated;
  const SlaveConfig& c = loop_.slave()->config();
  const auto truth = std::visit([](const auto& r) { return r.truth(); }, *loop_.robot());
  const bool touches = !truth.F_E_S.force.isZero();
  wound_ *= 1 - c.Ts * c.servo.integral_per_s;
  if (touches) wound_ = std::max(wound_, wind_up(t, truth.F_E_S));
  if (!t.coupled) {
    coupled_ = false;
    return;
  }
  const Vec3 p_cmd = forward(c.arm, t.q_cmd).p;
  if (!coupled_) ideal_.start(p_cmd);
  coupled_ = true;
  const Vec3 p_ideal = ideal_.step(p_cmd);
  const bool held = (t.limits & kHeldBack) != 0;
  held_ = touches ? kRecovery : std::clamp(held_ + (held ? kRecoveryPerTick : -1), 0, kRecovery);
  if (judged && !held && held_ == 0) judge(p_cmd, p_ideal, truth.X_SE.p);
}

void Tracking::judge(const Vec3& p_cmd, const Vec3& p_ideal, const Vec3& p_SE) {
  const Vec3 asked = wanted_tool(*loop_.slave(), loop_.slave_end()->newest()->message.p_MH);
  const Vec3 wanted = wanted_tool(*loop_.slave(), true_handle(loop_.device(), asked));
  const double command = (asked - p_cmd).norm(), tool = (p_ideal - p_SE).norm();
  lag_.add((wanted - p_SE).norm());
  command_.add(command);
  tool_.add(std::max(tool - wound_, 0.0));
  checkers_.expect(command <= limits_.command, "the command is off what is asked for [m]", command,
                   limits_.command);
  checkers_.expect(tool <= limits_.tool + wound_, "the tool is off where its servo drives it [m]",
                   tool, limits_.tool + wound_);
}

double Tracking::wind_up(const SlaveTick& t, const Wrench& F_E_S) const noexcept {
  const SlaveConfig& c = loop_.slave()->config();
  const ArmJacobian J = kinematics(c.arm, t.q_cmd).J;
  Vec6 off = joint_torques(J, F_E_S);
  for (int i = 0; i < 6; ++i) off[i] /= joint_gains(c.servo, c.servo.inertia[i], 1).kp;
  return (J.linear * off).norm();
}

}  // namespace farhand
