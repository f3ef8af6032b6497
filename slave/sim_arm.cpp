#include "slave/sim_arm.hpp"

#include <algorithm>
#include <cmath>

#include "common/pid.hpp"

namespace farhand {
namespace {

// A joint that turns by more than this in a step gets more, shorter steps. No working robot does at
// 1 kHz (20 rad/s); an arm in free fall does, and there one RK4 step per millisecond would lose
// about 2e-6 J a minute instead of 1e-7.
constexpr double kMaxTurn = 0.02;  // [rad]
constexpr int kMaxSubsteps = 8;

// Ten times as far as the drives can throw a resting tip within a step of 1.5 ms.
constexpr double kMaxTravelFromRest = 0.005;  // [m]

}  // namespace

SimArm::SimArm(const SimArmConfig& config) noexcept
    : config_(config),
      arm_(make_arm_dynamics(config.model)),
      gears_(make_gear_friction(config.model, 1 / config.rate_hz)),
      random_(config.seed),
      q_(config.q),
      feet_(config.q) {
  for (std::size_t i = 0; i < 6; ++i)
    torque_limit_[static_cast<Eigen::Index>(i)] = config.model.links[i].torque_limit;
}

RobotReading SimArm::read(TimePoint now) noexcept {
  advance(now);
  RobotReading out{.ok = q_.allFinite() && dq_.allFinite(), .q = q_, .dq = dq_};
  if (!out.ok) return {};
  const double quantum = config_.encoder_quantum_rad;
  if (quantum > 0) out.q = (q_ / quantum).array().round() * quantum;
  if (config_.velocity == VelocitySource::encoder) read_velocity(now, out);
  out.F_E_S = sensed(tip(q_, dq_));
  return out;
}

void SimArm::write(TimePoint now, const Vec6& tau) noexcept {
  advance(now);
  const bool good = tau.allFinite();
  if (!good) ++status_.bad_torques;
  tau_ = good ? Vec6(tau.cwiseMax(-torque_limit_).cwiseMin(torque_limit_)) : Vec6::Zero();
}

void SimArm::advance(TimePoint now) noexcept {
  if (!started_) first_ = last_ = now, started_ = true;
  if (now <= last_) return;
  const Duration elapsed = now - last_, simulated = std::min(elapsed, kMaxCatchUp);
  last_ = now;
  move_surfaces();
  status_.skipped += elapsed - simulated;
  const double T = seconds(simulated);
  const int n = std::max(1, static_cast<int>(std::lround(T * config_.rate_hz)));
  for (int i = 0; i < n; ++i) step(T / n);
  if (elapsed > simulated) dq_.setZero();
}

void SimArm::move_surfaces() noexcept {
  for (; surfaces_moved_ < config_.surface_steps.size(); ++surfaces_moved_) {
    const SurfaceStep& s = config_.surface_steps[surfaces_moved_];
    if (last_ - first_ < s.at) return;
    move(config_.surfaces.items[s.surface].shape, s.by);
  }
}

void SimArm::step(double h) noexcept {
  const double turn = h * dq_.cwiseAbs().maxCoeff();
  if (turn < kMaxTurn) return runge_kutta(h);
  const int n =
      turn < kMaxSubsteps * kMaxTurn ? 1 + static_cast<int>(turn / kMaxTurn) : kMaxSubsteps;
  for (int i = 0; i < n; ++i) runge_kutta(h / n);
}

// The classical fourth-order method, written for q'' = f(q, q').
void SimArm::runge_kutta(double h) noexcept {
  if (config_.surfaces.count > 0) look_for_contact(h);
  const Vec6 a1 = acceleration(q_, dq_);
  const Vec6 v2 = dq_ + h / 2 * a1;
  const Vec6 a2 = acceleration(q_ + h / 2 * dq_, v2);
  const Vec6 v3 = dq_ + h / 2 * a2;
  const Vec6 a3 = acceleration(q_ + h / 2 * v2, v3);
  const Vec6 v4 = dq_ + h * a3;
  const Vec6 a4 = acceleration(q_ + h * v3, v4);
  q_ += h * dq_ + h * h / 6 * (a1 + a2 + a3);
  dq_ += h / 6 * (a1 + 2 * (a2 + a3) + a4);
  if (config_.friction) drag_feet(gears_, q_, feet_);
  ++status_.steps;
}

// Far from every surface the inner stages need not look. Far: out of reach within this step at
// twice the present joint speeds and then some.
void SimArm::look_for_contact(double h) noexcept {
  const ArmFrames frames = arm_frames(arm_, joint_trig(q_));
  const double reach = arm_.a2 + arm_.d4 + arm_.d6;
  const double travel = kMaxTravelFromRest + 2 * h * reach * dq_.cwiseAbs().sum();
  const double depth = penetration(config_.surfaces, frames.X_SE.p, config_.tip_radius_m);
  near_ = !(depth < -travel);
  if (near_) {
    const Tip now{frames.X_SE, tool_twist(frames, dq_), config_.tip_radius_m};
    update_anchors(config_.surfaces, contact_, now);
  }
}

Vec6 SimArm::acceleration(const Vec6& q, const Vec6& dq) const noexcept {
  const JointTrig trig = joint_trig(q);
  Vec6 tau = tau_;
  if (config_.friction) tau += friction_torque(gears_, feet_, q, dq);
  if (near_) {
    const ArmFrames frames = arm_frames(arm_, trig);
    if (penetration(config_.surfaces, frames.X_SE.p, config_.tip_radius_m) > 0) {
      const Tip at{frames.X_SE, tool_twist(frames, dq), config_.tip_radius_m};
      tau -= joint_torques(frames, contact_wrench(config_.surfaces, contact_, at));
    }
  }
  return forward_dynamics(arm_, trig, dq, tau);
}

Tip SimArm::tip(const Vec6& q, const Vec6& dq) const noexcept {
  const ArmFrames frames = arm_frames(arm_, joint_trig(q));
  return {frames.X_SE, tool_twist(frames, dq), config_.tip_radius_m};
}

Wrench SimArm::sensed(const Tip& tip) noexcept {
  const SensorConfig& s = config_.sensor;
  update_anchors(config_.surfaces, contact_, tip);
  const Vec3 weight = s.tool_mass_kg * arm_.gravity, lever = tip.X_SE.R * s.tool_com_E;
  Wrench F = contact_wrench(config_.surfaces, contact_, tip) + tip.X_SE.R * s.bias_E -
             Wrench{weight, lever.cross(weight)};
  if (s.force_noise_newton > 0)
    for (double& x : F.force) x += s.force_noise_newton * random_.normal();
  if (s.torque_noise_newton_metre > 0)
    for (double& x : F.torque) x += s.torque_noise_newton_metre * random_.normal();
  return F;
}

void SimArm::read_velocity(TimePoint now, RobotReading& out) noexcept {
  if (measured_ && now > last_read_) {
    const double T = seconds(now - last_read_);
    dq_read_ += low_pass_gain(config_.velocity_cutoff_hz, T) * ((out.q - q_read_) / T - dq_read_);
  }
  if (!measured_ || now > last_read_) q_read_ = out.q, last_read_ = now, measured_ = true;
  out.dq = dq_read_;
}

SimArmTruth SimArm::truth() const noexcept {
  const Tip at = tip(q_, dq_);
  ContactState contact = contact_;
  update_anchors(config_.surfaces, contact, at);
  return {.q = q_,
          .dq = dq_,
          .tau = tau_,
          .X_SE = at.X_SE,
          .V_E_S = at.V_E_S,
          .F_E_S = contact_wrench(config_.surfaces, contact, at),
          .penetration = penetration(config_.surfaces, at.X_SE.p, at.radius),
          .energy = energy(arm_, q_, dq_)};
}

}  // namespace farhand
