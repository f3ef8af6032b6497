// The force controllers that the single-axis model is run with, and the margin of their command.
#pragma once

#include <array>
#include <limits>

#include "tests/support/axis_model.hpp"
#include "tests/support/gain_margin.hpp"

namespace farhand::axis {

// Wide, so that they hide nothing.
inline ForceControllerConfig open_loop() {
  return {
      .limits = {.force = 40, .torque = 2, .twist_torque = 1, .force_step = 5, .torque_step = 1}};
}

inline ForceControllerConfig with_loop(const PidConfig& gains, double cutoff_hz,
                                       bool filter_error) {
  ForceControllerConfig c = open_loop();
  c.closed_loop = ForceLoopConfig{.filter_error = filter_error};
  c.closed_loop->axes.fill({.gains = gains, .cutoff_hz = cutoff_hz});
  return c;
}

// kp, ki and kd of the publication (section 9.1).
inline ForceControllerConfig published() {
  return with_loop({.kp = 1.2, .ki = 0.36, .kd = 0.0011}, 30, false);
}

// Beyond it: the error through 8.5 Hz, the device's model fed forward, damping in contact.
// motor_delay: ticks from a command to its push.
inline ForceControllerConfig ours(int motor_delay) {
  ForceControllerConfig c = with_loop({.kp = 8.8, .ki = 8.8 * kTurn * 3}, 8.5, true);
  c.device = DeviceConfig{.motor_delay = motor_delay};
  c.feedforward = DeviceFeedforwardConfig{};
  c.contact_damping = ContactDampingConfig{};
  return c;
}

// The same for motors that come late and a sensor that is slow.
inline ForceControllerConfig ours_slow(int motor_delay) {
  ForceControllerConfig c = ours(motor_delay);
  for (ForceAxisConfig& axis : c.closed_loop->axes) axis.gains = {.kp = 5, .ki = 5 * kTurn * 3};
  c.device->observer = {.velocity_hz = 20, .acceleration_hz = 12};
  c.feedforward = DeviceFeedforwardConfig{
      .damping = 0.8, .friction = 0.8, .inertia = 0.5, .friction_lead = 0.004};
  return c;
}

// Of the whole command times `gain`; moved as in H1.
inline Unrest unrest(const LoopConfig& config, double gain) {
  Unrest out{};
  for (std::size_t i = 0; i < out.size(); ++i) {
    LoopConfig c = config;
    c.command_gain = gain;
    if (i == 2) c.device.F_k = 0;
    const auto moved = h1_wish();
    const auto wish = [&](double t) {
      return i == 1 ? moved(t) : Wish{t < 0.3 ? 0.002 : 0, 0};  // held still after a start
    };
    Loop loop(c);
    double u = 0, sum = 0;
    int count = 0;
    while (loop.last().t < 6 && std::abs(loop.last().x) < 10) {
      const Tick& t = loop.tick(wish);
      if (t.t > 4) sum += (t.u - u) * (t.u - u), ++count;
      u = t.u;
    }
    out[i] = loop.last().t < 6 ? std::numeric_limits<double>::infinity() : std::sqrt(sum / count);
  }
  return out;
}

inline double margin_db(const LoopConfig& config) {
  return gain_margin_db([&](double gain) { return unrest(config, gain); });
}

// H2 and H3 from 16 s on, in contact.
struct Contact {
  double rms = 0, peak = 0;  // [N] of F_u - F_e
  double F_e = 0;            // [N] largest
};
inline Contact contact(const LoopConfig& config) {
  Loop loop(config);
  Contact out;
  int count = 0;
  while (loop.last().t < 25) {
    const Tick& t = loop.tick(h2_wish);
    if (t.t < 16) continue;
    const double e = t.F_u - t.F_e;
    out.rms += e * e, ++count;
    out.peak = std::max(out.peak, std::abs(e));
    out.F_e = std::max(out.F_e, t.F_e);
  }
  out.rms = std::sqrt(out.rms / count);
  return out;
}

}  // namespace farhand::axis
