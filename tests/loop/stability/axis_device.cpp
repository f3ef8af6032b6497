#include "tests/loop/stability/axis_device.hpp"

#include "common/pid.hpp"

namespace farhand {

std::optional<AxisDevice> axis_device(const ForceControllerConfig& config, bool has_sensor) {
  if (!config.device) return {};
  const DeviceGroup& model = config.device->model.translation;
  AxisDevice out{.mass = model.inertia,
                 .damping = model.damping,
                 .observer = config.device->observer,
                 .motor_delay = config.device->motor_delay,
                 .senses_user = has_sensor};
  if (config.feedforward) {
    out.fed_damping = config.feedforward->damping * model.damping;
    out.fed_inertia = config.feedforward->inertia * model.inertia;
  }
  if (config.contact_damping) out.contact_damping = config.contact_damping->translation;
  if (config.disturbance) {
    out.disturbance_share = config.disturbance->share;
    out.disturbance_cutoff_hz = config.disturbance->cutoff_hz;
  }
  return out;
}

AxisDeviceStages::AxisDeviceStages(const AxisDevice& d, double Ts) noexcept
    : device_(d),
      Ts_(Ts),
      disturbance_gain_(low_pass_gain(d.disturbance_cutoff_hz, Ts)),
      on_model_(observer_gains(d.observer.velocity_hz, Ts)),
      on_pose_(observer_gains(d.observer.acceleration_hz, Ts)) {}

AxisDeviceState AxisDeviceStages::rest() const {
  AxisDeviceState state;
  state.given = Eigen::VectorXd::Zero(device_.motor_delay + 1);
  return state;
}

double AxisDeviceStages::observe(AxisDeviceState& s, double x, double F_u) const noexcept {
  const double dx = x - s.x, given = s.given[device_.motor_delay];
  s.x = x;

  const double load = (device_.senses_user ? F_u : 0) + given + s.rest;
  const double v = (device_.mass * s.v + Ts_ * load) / (device_.mass + Ts_ * device_.damping);
  const double e = s.off_model + dx - Ts_ / 2 * (s.v + v);
  s.off_model = (1 - on_model_.x) * e;
  s.v = v + on_model_.v * e;
  s.rest += device_.mass * on_model_.a * e;

  const double e_pose = s.off_pose + dx - Ts_ * (s.v_pose + Ts_ / 2 * s.a);
  s.off_pose = (1 - on_pose_.x) * e_pose;
  s.v_pose += Ts_ * s.a + on_pose_.v * e_pose;
  s.a += on_pose_.a * e_pose;

  s.disturbance += disturbance_gain_ * (s.rest - s.disturbance);
  return device_.senses_user ? F_u : s.disturbance;
}

double AxisDeviceStages::load(const AxisDeviceState& s) const noexcept {
  return device_.fed_damping * s.v + device_.fed_inertia * s.a -
         device_.disturbance_share * s.disturbance;
}

void AxisDeviceStages::remember(AxisDeviceState& s, double command) const noexcept {
  for (int i = device_.motor_delay; i > 0; --i) s.given[i] = s.given[i - 1];
  s.given[0] = command;
}

}  // namespace farhand
