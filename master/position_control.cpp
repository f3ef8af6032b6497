#include "master/position_control.hpp"

namespace farhand {

PositionControl::PositionControl(const PositionControlConfig& config, double Ts)
    : config_(config), pid_(make_pid(config.pid, Ts)) {}

Vec3 PositionControl::step(TimePoint now, const Vec3& p_MH, LimitSet& set) noexcept {
  if (!started_) started_ = true, start_ = now, target_ = p_MH;
  while (next_ < config_.set_points.size() && now - start_ >= config_.set_points[next_].at)
    target_ = config_.set_points[next_++].p_MH;

  constexpr double kGravity = 9.81;
  const Vec3 weight = config_.gravity_mass * kGravity * config_.up_M;
  Vec3 f;
  for (int i = 0; i < 3; ++i) {
    f[i] = farhand::step(pid_, state_[i], target_[i], p_MH[i]);
    if (state_[i].saturated) set |= kLimitSaturated;
  }
  const Vec3 wanted = f + weight;
  const Vec3 out = clamp_norm(wanted, config_.max_force);
  if (out != wanted) set |= kLimitForce;
  return out;
}

}  // namespace farhand
