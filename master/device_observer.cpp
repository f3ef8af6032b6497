#include "master/device_observer.hpp"

#include <numbers>

namespace farhand {

ObserverGains observer_gains(double hz, double Ts) noexcept {
  const double p = std::exp(-2 * std::numbers::pi * hz * Ts), q = 1 - p;
  return {.x = 1 - p * p * p, .v = 1.5 * q * q * (1 + p) / Ts, .a = q * q * q / (Ts * Ts)};
}

DeviceObserver::DeviceObserver(const DeviceModel& model, const DeviceObserverConfig& config,
                               double Ts) noexcept
    : model_(model),
      inertia_(per_axis(model.translation.inertia, model.tilt.inertia, model.twist.inertia)),
      Ts_(Ts),
      on_model_(observer_gains(config.velocity_hz, Ts)),
      on_pose_(observer_gains(config.acceleration_hz, Ts)) {}

// Since the last sample. The turn of the axis is small, so that the cross product is its angle.
DeviceAxes DeviceObserver::moved(const HandlePose& pose) noexcept {
  DeviceAxes out;
  out << (pose.X_MH.p - last_.X_MH.p).array(), last_.R_MG.col(2).cross(pose.R_MG.col(2)).array(),
      pose.twist - last_.twist;
  last_ = pose;
  return out;
}

const DeviceMotion& DeviceObserver::step(const HandlePose& pose, const DeviceAxes& known) noexcept {
  if (!primed_) {
    primed_ = true;
    last_ = pose;
    off_model_ = off_pose_ = v_pose_ = DeviceAxes::Zero();
    motion_ = {};
    return motion_;
  }
  const DeviceAxes dx = moved(pose);

  DeviceAxes load = known + motion_.rest;
  load.segment<3>(0) += model_.weight_M.array();
  const DeviceAxes v = (inertia_ * motion_.v + Ts_ * load) /
                       (inertia_ + Ts_ * drag(model_, motion_.v));  // drag can only brake
  const DeviceAxes e = off_model_ + dx - Ts_ / 2 * (motion_.v + v);
  off_model_ = (1 - on_model_.x) * e;
  motion_.v = v + on_model_.v * e;
  motion_.rest += inertia_ * (on_model_.a * e);

  const DeviceAxes e_pose = off_pose_ + dx - Ts_ * (v_pose_ + Ts_ / 2 * motion_.a);
  off_pose_ = (1 - on_pose_.x) * e_pose;
  v_pose_ += Ts_ * motion_.a + on_pose_.v * e_pose;
  motion_.a += on_pose_.a * e_pose;
  return motion_;
}

}  // namespace farhand
