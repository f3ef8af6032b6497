#include "master/build_force.hpp"

#include <spdlog/fmt/fmt.h>

#include <numbers>

#include "common/scene_values.hpp"

namespace farhand {
namespace {

constexpr double kMilli = 1e-3;

ForceAxisConfig force_axis(const proto::ForceGains& g, const proto::ClosedLoop& l) {
  return {.gains = {.kp = g.kp(),
                    .ki = g.ki_per_s(),
                    .kd = g.kd_s(),
                    .derivative_cutoff_hz = g.derivative_cutoff_hz()},
          .cutoff_hz = g.has_cutoff_hz() ? g.cutoff_hz() : l.cutoff_hz()};
}

ForceLoopConfig closed_loop(const proto::ClosedLoop& l, bool rotates) {
  const ForceAxisConfig none, force = force_axis(l.force(), l),
                              torque = rotates ? force_axis(l.torque(), l) : none,
                              twist = rotates ? force_axis(l.twist(), l) : none;
  ForceLoopConfig c{.axes = {force, force, force, torque, torque, twist},
                    .filter_error = l.filter() == proto::ClosedLoop::ERROR};
  for (const auto& a : l.axis())
    c.axes[static_cast<std::size_t>(a.axis())] = force_axis(a.gains(), l);
  return c;
}

DeviceConfig device(const proto::Master& master, double Ts) {
  // The speeds at which friction is near its full size are the model's own, reference section 9.3.
  const proto::DeviceModel& m = master.force_feedback().device_model();
  const Vec3 down_M = master.has_falcon() ? Vec3(0, -1, 0) : Vec3(0, 0, -1);
  DeviceModel model;
  model.translation.inertia = m.mass_kg();
  model.translation.damping = m.damping_newton_s_per_m();
  model.translation.friction = m.friction_newton();
  model.tilt.inertia = m.rotation_inertia_kg_m2();
  model.tilt.damping = m.rotation_damping_newton_m_s();
  model.tilt.friction = m.rotation_friction_newton_m();
  model.twist.inertia = m.twist_inertia_kg_m2();
  model.twist.damping = m.twist_damping_newton_m_s();
  model.weight_M = m.weight_newton() * down_M;
  return {.model = model,
          .observer = {.velocity_hz = m.velocity_hz(), .acceleration_hz = m.acceleration_hz()},
          .motor_delay = static_cast<int>(std::lround(m.motor_delay_ms() * kMilli / Ts)),
          .feels_user = !master.has_falcon()};
}

DeviceFeedforwardConfig feedforward(const proto::DeviceFeedforward& f) {
  return {.gravity = f.gravity_share(),
          .damping = f.damping_share(),
          .friction = f.friction_share(),
          .inertia = f.inertia_share(),
          .rotation_inertia = f.rotation_inertia_share(),
          .friction_lead = f.friction_lead_ms() * kMilli};
}

ContactDampingConfig contact_damping(const proto::ContactDamping& d) {
  return {.translation = d.damping_newton_s_per_m(),
          .tilt = d.rotation_damping_newton_m_s(),
          .twist = d.twist_damping_newton_m_s(),
          .force = d.force_newton(),
          .torque = d.torque_newton_meter(),
          .fade_time = d.fade_ms() * kMilli};
}

// Of one pole, for slow signals [ms].
double delay_ms(double cutoff_hz) {
  return cutoff_hz > 0 ? 1e3 / (2 * std::numbers::pi * cutoff_hz) : 0;
}

}  // namespace

ForceFeedbackConfig force_feedback_config(const proto::Master& master, double Ts) {
  const proto::ForceFeedback& f = master.force_feedback();
  ForceFeedbackConfig c{
      .compensation = {.hold = milliseconds(f.hold_ms()), .fade = milliseconds(f.fade_ms())},
      .controller = {.limits = {.force = f.max_force_newton(),
                                .torque = f.max_torque_newton_meter(),
                                .twist_torque = f.max_twist_torque_newton_meter(),
                                .force_step = f.max_force_rate_newton_per_s() * Ts,
                                .torque_step = f.max_torque_rate_newton_meter_per_s() * Ts},
                     .switching_share = f.switching_rate_share()}};
  ForceControllerConfig& k = c.controller;
  if (f.has_closed_loop()) k.closed_loop = closed_loop(f.closed_loop(), master.has_twin_delta());
  if (f.has_device_model()) k.device = device(master, Ts);
  if (f.has_device_feedforward()) k.feedforward = feedforward(f.device_feedforward());
  if (f.has_contact_damping()) k.contact_damping = contact_damping(f.contact_damping());
  if (f.has_disturbance_observer())
    k.disturbance = {.share = master.has_falcon() ? 0 : f.disturbance_observer().share(),
                     .cutoff_hz = f.disturbance_observer().cutoff_hz()};
  return c;
}

std::vector<std::string> force_stages(const proto::Master& master) {
  const proto::ForceFeedback& f = master.force_feedback();
  std::vector<std::string> out;
  if (f.has_device_model())
    out.push_back(
        fmt::format("device_model      velocity observed at {:g} Hz, acceleration at {:g} Hz",
                    f.device_model().velocity_hz(), f.device_model().acceleration_hz()));
  if (f.has_disturbance_observer())
    out.push_back(fmt::format(
        "disturbance       {}, pole at {:g} Hz (delay {:.1f} ms)",
        master.has_falcon() ? "estimate of the user's force" : "a share of what the model leaves",
        f.disturbance_observer().cutoff_hz(), delay_ms(f.disturbance_observer().cutoff_hz())));
  if (f.has_contact_damping())
    out.push_back(fmt::format("contact_damping   {:g} N s/m above {:g} N",
                              f.contact_damping().damping_newton_s_per_m(),
                              f.contact_damping().force_newton()));
  if (f.has_device_feedforward())
    out.push_back(fmt::format(
        "feedforward       weight {:g}, damping {:g}, friction {:g}, inertia {:g} of the model",
        f.device_feedforward().gravity_share(), f.device_feedforward().damping_share(),
        f.device_feedforward().friction_share(), f.device_feedforward().inertia_share()));
  if (f.has_closed_loop())
    out.push_back(fmt::format("closed_loop       PID on {}, pole at {:g} Hz (delay {:.1f} ms)",
                              master.has_falcon() ? "the estimated force" : "six axes",
                              f.closed_loop().cutoff_hz(), delay_ms(f.closed_loop().cutoff_hz())));
  out.push_back(fmt::format("force_controller  {}, at most {:g} N",
                            f.has_closed_loop() ? "closed loop" : "open-loop reflection",
                            f.max_force_newton()));
  return out;
}

}  // namespace farhand
