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

namespace {

// How long the newest message's velocity leads on while no newer one comes [s].
double reckoned(const SlaveConfig& c, Duration age) {
  if (!c.compensated) return 0;
  return std::visit(
      [&](const auto& method) -> double {
        if constexpr (requires { method.concealment; }) return path(method.concealment, age);
        if constexpr (requires { method.mediated; }) return path(method.mediated.concealment, age);
        return 0;
      },
      *c.compensated);
}

}  // namespace

Tracking::Tracking(const Loopback& loop, Checkers& checkers, const Limits& limits,
                   const std::optional<Wall>& wall) noexcept
    : loop_(loop),
      checkers_(checkers),
      limits_(limits),
      at_limit_(loop),
      ideal_(loop.slave()->config().servo, loop.slave()->config().Ts),
      dynamics_(make_arm_dynamics(loop.slave()->config().model)),
      wall_(wall) {}

void Tracking::sampling() noexcept {
  const std::uint64_t next = loop_.master_end().sequence() + 1;
  given_[next % given_.size()] = true_handle(loop_.device(), Vec3::Zero());
}

void Tracking::check(const SlaveTick& t, bool judged) {
  constexpr LimitSet kHeldBack = kLimitWorkspace | kLimitSpeed | kLimitForce | kLimitSaturated;
  const SlaveConfig& c = loop_.slave()->config();
  const auto truth = std::visit([](const auto& r) { return r.truth(); }, *loop_.robot());
  const bool touches = !truth.F_E_S.force.isZero();
  wound_ *= 1 - c.Ts * c.servo.integral_per_s;
  if (touches) wound_ = std::max(wound_, wind_up(t, truth.F_E_S));
  weigh(t, truth.q);
  if (!t.coupled) {
    coupled_ = false;
    at_limit_.reset();
    return;
  }
  const MasterToSlave& newest = loop_.slave_end()->newest()->message;
  const Vec3 led_on = reckoned(c, t.age) * newest.V_MH.linear;
  Places at{.p_cmd = forward(c.arm, t.q_cmd).p,
            .p_SE = truth.X_SE.p,
            .asked = wanted_tool(*loop_.slave(), newest.p_MH + led_on),
            .led_on = c.workspace.scale * led_on.norm()};
  if (!coupled_) start(at);
  at.p_ideal = ideal_.step(at.p_cmd);
  if (!asked_.empty()) asked_[next_++ % asked_.size()] = at.asked;
  const bool held = (t.limits & kHeldBack) != 0;
  touched_ = touches ? kRecovery : std::max(touched_ - 1, 0);
  held_ = std::clamp(held_ + (held ? kRecoveryPerTick : -1), 0, kRecovery);
  clear_ = clear(at) ? clear_ + 1 : 0;
  const bool at_limit = at_limit_.step(t, truth.q);
  checkers_.expect(!judged || !held || at_limit, "a limit is reported where there is none",
                   static_cast<double>(t.limits), 0);
  const bool limited = held || held_ > 0;
  if (!judged || limited || touched_ > 0) offset_.reset();
  drift(at, limited || touches);
  if (!judged) return;
  limited_ += limited;
  free_ += clear_ > kFree;
  if (!limited && touched_ == 0) judge(at);
}

// The guard of direct feedback holds the command off in contact, and lets it drift back.
void Tracking::drift(const Places& at, bool held) noexcept {
  const auto& method = loop_.slave()->config().compensated;
  const auto* direct = method ? std::get_if<DirectTargetConfig>(&*method) : nullptr;
  if (direct == nullptr) return;
  const VelocityGuardConfig& guard = direct->translation;
  const double speed = std::min(held_off_ / guard.drift_time, guard.drift_speed);
  held_off_ = held ? (at.asked - at.p_cmd).norm() : held_off_ - guard.Ts * speed;
}

void Tracking::start(const Places& at) noexcept {
  ideal_.start(at.p_cmd);
  coupled_ = true;
  clear_ = 0;
  asked_.assign(static_cast<std::size_t>(limits_.played_out), at.asked);
}

// By more than the command and the tool may be off.
bool Tracking::clear(const Places& at) const noexcept {
  if (!wall_) return true;
  const Vec3& p = limits_.keeps_offset ? at.p_cmd : at.asked;
  return wall_->normal.dot(p - wall_->point) > limits_.command + limits_.tool;
}

// The most that what is asked for is from what may be played out only now [m].
double Tracking::moved_lately() const noexcept {
  double most = 0;
  for (const Vec3& p : asked_)
    most = std::max(most, (p - asked_[(next_ - 1) % asked_.size()]).norm());
  return most;
}

void Tracking::judge(const Places& at) {
  ++judged_;
  const Slave& slave = *loop_.slave();
  const auto& newest = *loop_.slave_end()->newest();
  const Vec3 p_MH_now = true_handle(loop_.device(), newest.message.p_MH);
  Vec3 asked = at.asked, wanted = wanted_tool(slave, p_MH_now);
  double room = limits_.command + held_off_ + moved_lately();
  if (limits_.keeps_offset) {
    if (!offset_) offset_ = {at.p_cmd - asked, room};
    asked += offset_->by, wanted += offset_->by;
    room += offset_->slack;
  }
  const double scale = slave.config().workspace.scale;
  const double most = limits_.tool + wound_ + sagged_;
  const double moved = (p_MH_now - given_[newest.sequence % given_.size()]).norm();
  const double command = (asked - at.p_cmd).norm(), tool = (at.p_ideal - at.p_SE).norm();
  const double lag = (wanted - at.p_SE).norm();
  const double explained =
      scale * (limits_.handle + moved) + room + at.led_on + (at.p_ideal - at.p_cmd).norm() + most;
  lag_.add(lag);
  command_.add(std::max(command - (room - limits_.command), 0.0));
  tool_.add(std::max(tool - wound_ - sagged_, 0.0));
  checkers_.expect(command <= room, "the command is off what is asked for [m]", command, room);
  checkers_.expect(tool <= most, "the tool is off where its servo drives it [m]", tool, most);
  checkers_.expect(lag <= explained, "the tool lags more than delay and servo explain [m]", lag,
                   explained);
}

// A servo that was started anew carries nothing yet.
void Tracking::weigh(const SlaveTick& t, const Vec6& q) noexcept {
  const SlaveConfig& c = loop_.slave()->config();
  if (c.servo.gravity_compensation) return;
  if (t.robot.ok && t.q_cmd == t.robot.q) carried_.setZero();
  const Vec6 lacking = gravity_torques(dynamics_, q) - carried_;
  carried_ += c.Ts * c.servo.integral_per_s * lacking;
  sagged_ = displaced(kinematics(c.arm, t.q_cmd).J, lacking);
}

double Tracking::wind_up(const SlaveTick& t, const Wrench& F_E_S) const noexcept {
  const ArmJacobian J = kinematics(loop_.slave()->config().arm, t.q_cmd).J;
  return displaced(J, joint_torques(J, F_E_S));
}

// The tool, by joint torques against the servos' stiffness [m].
double Tracking::displaced(const ArmJacobian& J, const Vec6& tau) const noexcept {
  const JointServoConfig& servo = loop_.slave()->config().servo;
  Vec6 off = tau;
  for (int i = 0; i < 6; ++i) off[i] /= joint_gains(servo, servo.inertia[i], 1).kp;
  return (J.linear * off).norm();
}

}  // namespace farhand
