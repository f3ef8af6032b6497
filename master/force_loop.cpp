#include "master/force_loop.hpp"

#include <cmath>

namespace farhand {
namespace {

double& axis(Wrench& F, std::size_t i) noexcept {
  return i < 3 ? F.force[static_cast<Eigen::Index>(i)] : F.torque[static_cast<Eigen::Index>(i) - 3];
}
double axis(const Wrench& F, std::size_t i) noexcept {
  return i < 3 ? F.force[static_cast<Eigen::Index>(i)] : F.torque[static_cast<Eigen::Index>(i) - 3];
}

}  // namespace

ForceLoop::ForceLoop(const ForceLoopConfig& config, double Ts) noexcept
    : filter_error_(config.filter_error) {
  for (std::size_t i = 0; i < pid_.size(); ++i) {
    pid_[i] = make_pid(config.axes[i].gains, Ts);
    gain_[i] = low_pass_gain(config.axes[i].cutoff_hz, Ts);
  }
}

Wrench ForceLoop::step(const Wrench& F_user_G, const Wrench& F_desired_G) noexcept {
  Wrench out;
  for (std::size_t i = 0; i < pid_.size(); ++i) {
    const double user = axis(F_user_G, i), desired = axis(F_desired_G, i);
    I_before_[i] = state_[i].I;
    if (!std::isfinite(user) || !std::isfinite(desired)) continue;
    const double input = filter_error_ ? user - desired : user;
    filtered_[i] = primed_ ? filtered_[i] + gain_[i] * (input - filtered_[i]) : input;
    axis(out, i) = farhand::step(pid_[i], state_[i], filtered_[i], filter_error_ ? 0 : desired);
  }
  primed_ = true;
  return out;
}

bool ForceLoop::unwind(const Wrench& missing) noexcept {
  bool any = false;
  for (std::size_t i = 0; i < pid_.size(); ++i) {
    double& I = state_[i].I;
    if (!((I - I_before_[i]) * axis(missing, i) > 0)) continue;
    I = I_before_[i];
    any = true;
  }
  return any;
}

void ForceLoop::reset() noexcept {
  primed_ = false;
  state_ = {};
  I_before_ = {};
}

}  // namespace farhand
