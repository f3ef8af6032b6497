#include "slave/force_sensing.hpp"

#include "common/limits.hpp"
#include "common/pid.hpp"

namespace farhand {

ForceSensing::ForceSensing(const ForceSensingConfig& config, double Ts) noexcept
    : config_(config), gain_(low_pass_gain(config.cutoff_hz, Ts)) {}

const Wrench& ForceSensing::step(const Wrench& raw_E_S, const Pose& X_SE) noexcept {
  if (!plausible(raw_E_S)) return F_E_S_;
  const Vec3 weight_S = config_.tool_mass * config_.gravity_S;
  const Wrench known{X_SE.R * config_.bias - weight_S, weight_S.cross(X_SE.R * config_.p_ET)};
  const Wrench clean = raw_E_S - known;
  if (!primed_) F_E_S_ = clean, primed_ = true;
  F_E_S_ = F_E_S_ + gain_ * (clean - F_E_S_);
  return F_E_S_;
}

}  // namespace farhand
