#include "tests/loop/checkers.hpp"

#include <spdlog/fmt/fmt.h>

namespace farhand {
namespace {

constexpr double kRounding = 1e-9;  // relative room for the limiters' own arithmetic
// The command never leaves the joint limits or speeds and brakes before the former; the simulated
// joint behind it may be pushed, and a servo of damping ratio 0.9 overshoots speeds.
constexpr double kOvershoot = 0.02;       // [rad]
constexpr double kSpeedOvershoot = 1.15;  // of the speed limit

double worst(const Vec6& x, const Vec6& limit) {
  return (x.cwiseAbs().cwiseQuotient(limit)).maxCoeff();
}

}  // namespace

Checkers::Checkers(const Loopback& loop) : loop_(loop) {}

void Checkers::expect(bool good, const char* what, double value, double limit) {
  if (good) return;
  constexpr std::size_t kKept = 20;
  ++count_;
  if (first_.size() < kKept)
    first_.push_back({seconds(loop_.now() - loop_.start()),
                      fmt::format("{}: {:.9g}, limit {:.9g}", what, value, limit)});
}

void Checkers::restarted(Side side) noexcept {
  if (side == Side::master) {
    master_mode_ = Mode::disconnected;
    motor_tau_.setZero();
    F_G_ = {};
    return;
  }
  slave_mode_ = Mode::disconnected;
  slave_seen_ = false;
  boundary_ = {};
}

void Checkers::check(const MasterTick& t) {
  const MasterConfig& c = loop_.master().config();
  expect(is_legal(master_mode_, t.mode), "illegal master transition", static_cast<int>(t.mode),
         static_cast<int>(master_mode_));
  expect(t.tau.allFinite() && is_finite(t.F_G) && t.handle.X_MH.p.allFinite(), "master not finite",
         NAN, 0);
  const double tau = t.tau.cwiseAbs().maxCoeff();
  const double step = (t.tau - motor_tau_).cwiseAbs().maxCoeff();
  const double max_step = c.max_motor_torque * c.Ts / c.torque_rise_time_s;
  expect(tau <= c.max_motor_torque * (1 + kRounding), "motor torque [N m]", tau,
         c.max_motor_torque);
  expect(step <= max_step * (1 + kRounding), "motor torque step [N m]", step, max_step);
  if (c.force_feedback) check_handle(t);
  if (c.position_control) check_position_control(t);
  master_mode_ = t.mode;
  motor_tau_ = t.tau;
  // Where no force is accepted none was given.
  F_G_ = (t.limits & kLimitAcceptance) != 0 ? Wrench{} : t.F_G;
}

void Checkers::check_handle(const MasterTick& t) {
  const WrenchLimits& limits = loop_.master().config().force_feedback->controller.limits;
  const double f = t.F_G.force.norm(), df = (t.F_G.force - F_G_.force).norm();
  expect(f <= limits.force * (1 + kRounding), "force on the hand [N]", f, limits.force);
  expect(df <= limits.force_step * (1 + kRounding), "force step on the hand [N]", df,
         limits.force_step);
  const double m = t.F_G.torque.norm(), dm = (t.F_G.torque - F_G_.torque).norm();
  expect(m <= limits.torque * (1 + kRounding), "torque on the hand [N m]", m, limits.torque);
  expect(dm <= limits.torque_step * (1 + kRounding), "torque step on the hand [N m]", dm,
         limits.torque_step);
}

void Checkers::check_position_control(const MasterTick& t) {
  const PositionControlConfig& c = *loop_.master().config().position_control;
  const double f = t.F_G.force.norm(), df = (t.F_G.force - F_G_.force).norm();
  expect(f <= c.max_force * (1 + kRounding), "force on the hand [N]", f, c.max_force);
  if (c.safe)
    expect(df <= c.safe->force_step * (1 + kRounding), "force step on the hand [N]", df,
           c.safe->force_step);
}

// What is sent beyond the contact is the boundary's, limited before it leaves the slave.
void Checkers::check_boundary(const SlaveTick& t) {
  const SlaveConfig& c = loop_.slave()->config();
  const WrenchLimits& limits = c.boundary->limits;
  const double scale = c.workspace.force_scale;
  const Wrench F = t.out.F_E_M - reflect(c.workspace, t.F_E_S), change = F - boundary_;
  const auto within = [&](const Vec3& x, double limit, const char* what) {
    expect(x.norm() <= scale * limit * (1 + kRounding), what, x.norm(), scale * limit);
  };
  within(F.force, limits.force, "force of the boundary [N]");
  within(change.force, limits.force_step, "force step of the boundary [N]");
  within(F.torque, limits.torque, "torque of the boundary [N m]");
  within(change.torque, limits.torque_step, "torque step of the boundary [N m]");
  boundary_ = F;
}

void Checkers::check(const SlaveTick& t) {
  const SlaveConfig& c = loop_.slave()->config();
  const auto truth = std::visit([](const auto& r) { return r.truth(); }, *loop_.robot());
  expect(is_legal(slave_mode_, t.mode), "illegal slave transition", static_cast<int>(t.mode),
         static_cast<int>(slave_mode_));
  expect(truth.q.allFinite() && truth.dq.allFinite() && t.tau.allFinite(), "robot not finite", NAN,
         0);

  const double command =
      std::max((c.joints.lower - t.q_cmd).maxCoeff(), (t.q_cmd - c.joints.upper).maxCoeff());
  expect(command <= kRounding, "joint command outside its limits [rad]", command, 0);
  const Vec6 below = c.joints.lower - truth.q, above = truth.q - c.joints.upper;
  const double outside = std::max(below.maxCoeff(), above.maxCoeff());
  expect(outside <= kOvershoot, "joint outside its limits [rad]", outside, kOvershoot);
  const double speed = worst(truth.dq, c.joints.speed);
  expect(speed <= kSpeedOvershoot, "joint speed, share of its limit", speed, kSpeedOvershoot);

  Vec6 tau_max;
  for (int i = 0; i < 6; ++i) tau_max[i] = c.model.links[i].torque_limit;
  expect(worst(t.tau, tau_max) <= 1 + kRounding, "joint torque, share of its limit",
         worst(t.tau, tau_max), 1);
  // After a fault it is held where it is found.
  const bool found = !robot_read_ && t.robot.ok && t.q_cmd == t.robot.q;
  if (slave_seen_) {
    const double step = found ? 0 : worst(t.q_cmd - q_cmd_, c.joints.speed * c.Ts);
    expect(step <= 1 + kRounding, "joint command step, share of its limit", step, 1);
    expect(t.coupled || found || t.q_cmd == q_cmd_, "joint command moved while not engaged", step,
           0);
    const double slew = worst(t.tau - joint_tau_, tau_max * (c.Ts / c.torque_rise_time_s));
    expect(slew <= 1 + kRounding, "joint torque step, share of its limit", slew, 1);
  }
  if (c.boundary) check_boundary(t);
  slave_mode_ = t.mode;
  slave_seen_ = true;
  robot_read_ = t.robot.ok;
  q_cmd_ = t.q_cmd;
  joint_tau_ = t.tau;
}

}  // namespace farhand
