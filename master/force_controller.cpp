#include "master/force_controller.hpp"

#include <algorithm>
#include <cmath>

namespace farhand {
namespace {

constexpr double kSwitchTime = 0.1;    // [s] between open and closed loop
constexpr double kSwitching = 0.2;     // [s] of slower changes after something came or went
constexpr double kMapRounding = 1e-9;  // relative, of a wrench through the motors' map and back

double size2(const Wrench& F) noexcept {
  return F.force.squaredNorm() + F.torque.squaredNorm();
}
bool missing_something(const Wrench& missing, const Wrench& wanted) noexcept {
  return size2(missing) > kMapRounding * kMapRounding * (1 + size2(wanted));
}

}  // namespace

ForceController::ForceController(const ForceControllerConfig& config, double Ts) noexcept
    : config_(config),
      switching_limits_(config.limits),
      switching_ticks_(static_cast<int>(std::lround(kSwitching / Ts))),
      closes_(config.closed_loop || config.device),
      share_step_(std::min(1.0, Ts / kSwitchTime)) {
  switching_limits_.force_step *= config.switching_share;
  switching_limits_.torque_step *= config.switching_share;
  if (config.closed_loop) loop_.emplace(*config.closed_loop, Ts);
  if (!config.device) return;
  observer_.emplace(config.device->model, config.device->observer, Ts);
  if (config.feedforward) feedforward_.emplace(*config.feedforward, config.device->model);
  if (config.contact_damping) contact_damping_.emplace(*config.contact_damping, Ts);
  if (config.disturbance) disturbance_.emplace(*config.disturbance, Ts);
}

const Wrench& ForceController::step(const ForceInputs& in, LimitSet& set) noexcept {
  Wrench F_env_G = in.F_env_G;
  if (!plausible(F_env_G)) F_env_G = {}, set |= kLimitNotFinite;
  wanted_ = closes_ ? beyond(in, F_env_G, set) - F_env_G : Wrench{} - F_env_G;
  F_G_ = limit_wrench(limits(in), wanted_, F_G_, set);
  return F_G_;
}

const WrenchLimits& ForceController::limits(const ForceInputs& in) noexcept {
  const There now{in.engaged, in.felt, in.F_user_G != nullptr, in.handle != nullptr};
  if (now != there_) switching_ = switching_ticks_;
  there_ = now;
  if (switching_ == 0) return config_.limits;
  --switching_;
  return switching_limits_;
}

// All that is more than the open loop, at its share.
Wrench ForceController::beyond(const ForceInputs& in, const Wrench& F_env_G,
                               LimitSet& set) noexcept {
  const Wrench* F_user_G =
      in.F_user_G != nullptr && plausible(*in.F_user_G) ? in.F_user_G : nullptr;
  const Wrench F_given_G = plausible(in.F_given_G) ? in.F_given_G : Wrench{};
  unwind(F_given_G, set);
  if (observer_) observe(in.handle, F_user_G, F_given_G);
  if (user_estimate() != nullptr) F_user_G = user_estimate();

  const bool active = in.engaged && in.handle != nullptr && (!loop_ || F_user_G != nullptr);
  if (active) {
    if (share_ == 0 && loop_) loop_->reset();
    DeviceAxes load = DeviceAxes::Zero();
    Wrench damping;
    if (contact_damping_) {
      const DeviceAxes more = contact_damping_->step(F_env_G, observer_->motion().v);
      load -= more;
      damping = from_device(in.handle->R_MG, more);
    }
    if (feedforward_) load += feedforward_->step(observer_->motion());
    if (disturbance_) load += disturbance_->against();
    beyond_ = observer_ ? from_device(in.handle->R_MG, load) : Wrench{};
    if (loop_) beyond_ = beyond_ + loop_->step(*F_user_G, F_env_G + damping);
  }
  share_ = std::clamp(share_ + (active ? share_step_ : -share_step_), 0.0, 1.0);
  return share_ * beyond_;
}

void ForceController::observe(const HandlePose* handle, const Wrench* F_user_G,
                              const Wrench& F_given_G) noexcept {
  newest_ = (newest_ + 1) % given_.size();
  given_[newest_] = F_given_G;
  if (handle == nullptr) return observer_->reset();
  const auto delay = static_cast<std::size_t>(config_.device->motor_delay);
  Wrench known_G = given_[(newest_ + given_.size() - delay) % given_.size()];
  if (F_user_G != nullptr) known_G = known_G + *F_user_G;
  const DeviceMotion& motion = observer_->step(*handle, to_device(handle->R_MG, known_G));
  if (!disturbance_) return;
  const DeviceAxes& rest = disturbance_->step(motion);
  if (!config_.device->feels_user) F_user_estimate_ = from_device(handle->R_MG, rest);
}

void ForceController::unwind(const Wrench& F_given_G, LimitSet& set) noexcept {
  if (!loop_) return;
  const Wrench missing = wanted_ - F_given_G;
  if (missing_something(missing, wanted_) && loop_->unwind(missing)) set |= kLimitSaturated;
}

}  // namespace farhand
