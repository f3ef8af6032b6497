#include "tests/loop/stability/axis_period.hpp"

#include <algorithm>
#include <cmath>
#include <limits>

#include "common/pid.hpp"

namespace farhand {
namespace {

using namespace std::chrono_literals;
constexpr Duration kLongestSpan = 2ms;  // between two solutions of the simulated handle's mechanism

struct Servo {
  Vec6 kp, ki, kd;
};

Servo gains(const JointServoConfig& c) {
  Servo out;
  for (int i = 0; i < 6; ++i) {
    const PidConfig g = joint_gains(c, c.inertia[i], std::numeric_limits<double>::infinity());
    out.kp[i] = g.kp, out.ki[i] = g.ki, out.kd[i] = g.kd;
  }
  return out;
}

}  // namespace

AxisPeriod::AxisPeriod(const AxisModel& m) : model_(m) {
  const Duration Ts = from_seconds(m.Ts), round_trip = m.to_slave + m.to_master;
  if (round_trip > m.cut_off) lag_ = static_cast<int>((round_trip - m.cut_off + Ts - 1ns) / Ts);
  const Duration acts = std::min(round_trip, m.cut_off);
  before_ = steps(acts);
  after_ = steps(Ts - acts);

  const Servo servo = gains(m.arm.servo);
  kp_ = servo.kp, half_ki_Ts_ = servo.ki * (m.Ts / 2), kd_ = servo.kd, kd_per_Ts_ = kd_ / m.Ts;
  servo_derivative_gain_ = low_pass_gain(m.arm.servo.derivative_cutoff_hz, m.Ts);
  command_gain_ = low_pass_gain(m.arm.servo.command_cutoff_hz, m.Ts);
  sensing_gain_ = low_pass_gain(m.sensing_cutoff_hz, m.Ts);
  if (m.device) device_.emplace(*m.device, m.Ts);
  if (m.force) {
    force_gain_ = low_pass_gain(m.force->cutoff_hz, m.Ts);
    force_derivative_gain_ = low_pass_gain(m.force->gains.derivative_cutoff_hz, m.Ts);
  }

  const auto M = m.arm.M.ldlt();
  Mat12 A = Mat12::Zero();
  A.topRightCorner<6, 6>().setIdentity();
  const Mat6 gg = m.arm.g * m.arm.g.transpose();
  A.bottomLeftCorner<6, 6>() = -M.solve(m.arm.K_g + m.wall.stiffness * gg);
  A.bottomRightCorner<6, 6>() = -m.wall.damping * M.solve(gg);
  Eigen::Matrix<double, 12, 6> B = Eigen::Matrix<double, 12, 6>::Zero();
  B.bottomRows<6>() = M.solve(Mat6::Identity());

  const long n = std::max(1L, std::lround(m.Ts * m.arm.rate_hz));
  const Mat12 A_step = A * (m.Ts / static_cast<double>(n)), one = Mat12::Identity();
  const Mat12 shares = one + A_step / 2 * (one + A_step / 3 * (one + A_step / 4));
  const Mat12 step = one + A_step * shares;
  const Eigen::Matrix<double, 12, 6> push = m.Ts / static_cast<double>(n) * shares * B;
  arm_ = one;
  torque_.setZero();
  for (long i = 0; i < n; ++i) {
    torque_ = step * torque_ + push;
    arm_ = step * arm_;
  }
}

AxisState AxisPeriod::rest() const {
  AxisState state;
  state.answers = Eigen::VectorXd::Zero(lag_);
  if (device_) state.device = device_->rest();
  return state;
}

std::vector<AxisPeriod::Steps> AxisPeriod::steps(Duration span) const {
  std::vector<Steps> out;
  while (span > Duration::zero()) {
    const Duration part = std::min(span, kLongestSpan);
    const long n = std::max(1L, std::lround(seconds(part) * model_.hand.rate_hz));
    out.push_back({n, seconds(part) / static_cast<double>(n)});
    span -= part;
  }
  return out;
}

double AxisPeriod::run(AxisState& s, std::optional<double> instead) const {
  const double x = s.x, F_u = s.F_u, answer = slave_tick(s);
  double F_e = answer;
  if (lag_ > 0) {
    F_e = s.answers[lag_ - 1];
    for (int i = lag_ - 1; i > 0; --i) s.answers[i] = s.answers[i - 1];
    s.answers[0] = answer;
  }
  hand(s, before_);
  const double asked = command(s, F_e, F_u, x);
  s.motor = instead.value_or(asked);
  hand(s, after_);
  return asked;
}

// A state that nothing uses is cleared: left alone it would be a pole at 1.
//
// The force it measures and the torque it gives both belong to the arm as it now is; only then may
// the arm move on.
double AxisPeriod::slave_tick(AxisState& s) const {
  const ArmAxis& arm = model_.arm;
  const double F = model_.wall.stiffness * arm.g.dot(s.q) + model_.wall.damping * arm.g.dot(s.dq);
  s.sensed += sensing_gain_ * (F - s.sensed);

  const double command = model_.scale * s.x;
  s.command_rate += command_gain_ * ((command - s.command) / model_.Ts - s.command_rate);
  const Vec6 e = arm.c * command - s.q, last_e = arm.c * s.command - s.last_q;
  s.command = command;
  if (arm.servo.integral_per_s > 0)
    s.servo_I += half_ki_Ts_.cwiseProduct(e + last_e);
  else
    s.servo_I.setZero();
  s.servo_D += servo_derivative_gain_ * (kd_per_Ts_.cwiseProduct(s.last_q - s.q) - s.servo_D);
  s.last_q = s.q;

  Vec6 tau = kp_.cwiseProduct(e) + s.servo_I + s.servo_D;
  if (arm.servo.gravity_compensation) tau += arm.K_g * s.q;
  if (arm.servo.velocity_feedforward)
    tau += arm.servo.velocity_feedforward->share * s.command_rate * kd_.cwiseProduct(arm.c);

  Eigen::Matrix<double, 12, 1> moved;
  moved << s.q, s.dq;
  moved = arm_ * moved + torque_ * tau;
  s.q = moved.head<6>();
  s.dq = moved.tail<6>();
  return model_.force_scale * s.sensed;
}

double AxisPeriod::command(AxisState& s, double F_e, double F_u, double x) const {
  if (!device_) return force_loop(s, F_e, F_u);
  const double felt = device_->observe(*s.device, x, F_u);
  const double F_d = F_e + device_->damping(*s.device);
  const double asked = force_loop(s, F_d, felt) + device_->load(*s.device);
  device_->remember(*s.device, asked);
  return asked;
}

// K_h (F_u - F_d) - F_d along the axis.
double AxisPeriod::force_loop(AxisState& s, double F_d, double F_u) const {
  if (!model_.force) {
    s.filtered = s.I = s.e = s.D = 0;
    return model_.reflects ? -F_d : 0;
  }
  const AxisForceLoop& f = *model_.force;
  s.filtered += force_gain_ * ((f.filter_error ? F_u - F_d : F_u) - s.filtered);
  const double e = f.filter_error ? s.filtered : s.filtered - F_d;
  s.I = f.gains.ki > 0 ? s.I + f.gains.ki * model_.Ts / 2 * (e + s.e) : 0;
  s.D += force_derivative_gain_ * (f.gains.kd / model_.Ts * (e - s.e) - s.D);
  s.e = e;
  return f.gains.kp * e + s.I + s.D - F_d;
}

void AxisPeriod::hand(AxisState& s, const std::vector<Steps>& span) const {
  const PlantConfig& device = model_.hand.device;
  const HandImpedance& hand = model_.hand.hand;
  const double mass = device.mass + hand.mass;
  for (const Steps& part : span)
    for (long i = 0; i < part.count; ++i) {
      const double spring = -hand.stiffness * s.x;
      const double v = (mass * s.v + part.h * (spring + s.motor)) /
                       (mass + part.h * (device.damping + hand.damping));
      s.F_u = spring - hand.damping * v - hand.mass / part.h * (v - s.v);
      s.v = v;
      s.x += part.h * v;
    }
}

}  // namespace farhand
