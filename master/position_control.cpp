#include "master/position_control.hpp"

#include <algorithm>

namespace farhand {
namespace {

// In safe motion the integral is for what is left near the target, friction and a wrong weight:
// above this share of the drive the error is the hand's or the way's doing.
constexpr double kIntegralShare = 0.25;

PidConfig tracking(const PositionControlConfig& config) {
  PidConfig pid = config.pid;
  if (config.safe) pid.derivative_on_measurement = true;
  return pid;
}

}  // namespace

PositionControl::PositionControl(const PositionControlConfig& config, double Ts)
    : config_(config),
      Ts_(Ts),
      pid_(make_pid(tracking(config), Ts)),
      weight_(config.gravity_mass * kGravity * config.up_M),
      drive_(config.max_force - config.gravity_mass * kGravity) {}

Vec3 PositionControl::step(TimePoint now, const PositionInput& in, LimitSet& set) noexcept {
  if (!started_) started_ = true, start_ = now, set_point_ = way_ = in.p_MH;
  travel(goal(now, in.park), in.p_MH);
  if (config_.danger_cue) shift(now, in.danger_M);
  target_ = way_ + shift_;
  if (config_.safe) return safe_force(in, set);

  const Vec3 wanted = pid(in.p_MH, set) + weight_;
  const Vec3 out = clamp_norm(wanted, config_.max_force);
  if (out != wanted) set |= kLimitForce;
  return out;
}

Vec3 PositionControl::goal(TimePoint now, bool park) noexcept {
  while (next_ < config_.set_points.size() && now - start_ >= config_.set_points[next_].at)
    set_point_ = config_.set_points[next_++].p_MH;
  return park && config_.park_p_MH ? *config_.park_p_MH : set_point_;
}

// At most as far ahead of the grip as what pulls it with all of the drive.
void PositionControl::travel(const Vec3& goal, const Vec3& p_MH) noexcept {
  if (!config_.safe) {
    way_ = goal;
    return;
  }
  const Vec3 next = way_ + clamp_norm(Vec3(goal - way_), config_.safe->max_speed * Ts_);
  const double ahead = (next - p_MH).norm();
  if (pid_.kp * ahead <= drive_ || ahead <= (way_ - p_MH).norm()) way_ = next;
}

void PositionControl::shift(TimePoint now, const Vec3& danger_M) noexcept {
  const DangerCueConfig& cue = *config_.danger_cue;
  Vec3 danger = is_finite(danger_M) ? danger_M : Vec3::Zero();
  for (const auto& s : cue.script)
    if (now - start_ >= s.at && now - start_ < s.at + s.lasting) danger += s.towards_M;
  const Vec3 wanted = -cue.max_shift * clamp_norm(danger, 1);
  shift_ += clamp_norm(Vec3(wanted - shift_), cue.shift_step);
}

Vec3 PositionControl::pid(const Vec3& p_MH, LimitSet& set) noexcept {
  Vec3 f;
  for (int i = 0; i < 3; ++i) {
    const PidState before = state_[i];
    f[i] = farhand::step(pid_, state_[i], target_[i], p_MH[i]);
    if (state_[i].saturated) set |= kLimitSaturated;
    if (config_.safe && pid_.kp * std::abs(state_[i].e) > kIntegralShare * drive_)
      state_[i].I = before.I, state_[i].I_lost = before.I_lost;
  }
  return f;
}

Vec3 PositionControl::safe_force(const PositionInput& in, LimitSet& set) noexcept {
  const Vec3 drive = clamp_norm(pid(in.p_MH, set), drive_);
  const Vec3 wanted = drive - (drive_ / config_.safe->max_speed) * in.v_MH + weight_;
  const Vec3 capped = clamp_norm(wanted, config_.max_force);
  if (capped != wanted) set |= kLimitForce;
  const Vec3 change = capped - last_force_;
  const Vec3 allowed = clamp_norm(change, config_.safe->force_step);
  if (allowed != change) set |= kLimitSlew;
  last_force_ = allowed == change ? capped : Vec3(last_force_ + allowed);
  return last_force_;
}

}  // namespace farhand
