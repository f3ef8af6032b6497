#include "tests/loop/stability/boundary.hpp"

#include <spdlog/fmt/fmt.h>

#include <cmath>

namespace farhand {
namespace {

constexpr double kStride = 1.15;  // of the walk
constexpr double kExact = 1e-4;   // of the boundary

struct Range {
  double least, most;
};
Range range(Parameter p) noexcept {
  constexpr Range kRanges[kParameters] = {{1, 1e6},    {0.01, 10}, {0.01, 100},
                                          {1e-4, 0.2}, {0.01, 20}, {0.01, 10}};
  return kRanges[static_cast<int>(p)];
}

proto::Surface* surface_of(proto::Scene& scene, int surface) {
  return scene.mutable_slave()->mutable_sim_arm()->mutable_surface(surface);
}

void scale(proto::ForceGains& g, double factor) {
  g.set_kp(factor * g.kp());
  g.set_ki_per_s(factor * g.ki_per_s());
  g.set_kd_s(factor * g.kd_s());
}

// 0: open loop.
void set_loop_gain(proto::Master& master, double kp) {
  proto::ForceFeedback& feedback = *master.mutable_force_feedback();
  if (kp == 0) return feedback.clear_closed_loop();
  if (master.has_twin_delta()) master.mutable_force_sensing();
  proto::ClosedLoop& loop = *feedback.mutable_closed_loop();
  const double factor = kp / loop.force().kp();
  scale(*loop.mutable_force(), factor);
  for (proto::AxisGains& axis : *loop.mutable_axis()) scale(*axis.mutable_gains(), factor);
}

// The model stays as right or wrong as it was.
void set_device_mass(proto::Master& master, double mass) {
  const double factor = mass / master.sim_hand().device_mass_kg();
  master.mutable_sim_hand()->set_device_mass_kg(mass);
  if (!master.force_feedback().has_device_model()) return;
  proto::DeviceModel& model = *master.mutable_force_feedback()->mutable_device_model();
  model.set_mass_kg(factor * model.mass_kg());
}

}  // namespace

ParameterText text(Parameter p) noexcept {
  constexpr ParameterText kTexts[kParameters] = {
      {"wall stiffness", "N/m", 1}, {"reflection gain", "", 1}, {"force loop kp", "", 1},
      {"round trip", "ms", 1e3},    {"device mass", "kg", 1},   {"hand mass", "kg", 1}};
  return kTexts[static_cast<int>(p)];
}

std::string quantity(Parameter p, double value) {
  const ParameterText words = text(p);
  const double shown = value * words.per_unit;
  return fmt::format(fmt::runtime(shown >= 1000 ? "{:.0f}{}{}" : "{:.3g}{}{}"), shown,
                     words.unit[0] != '\0' ? " " : "", words.unit);
}

double get(const Scene& scene, int surface, Parameter p) {
  const proto::Scene& s = scene.proto;
  switch (p) {
    case Parameter::wall_stiffness:
      return s.slave().sim_arm().surface(surface).stiffness_newton_per_m();
    case Parameter::reflection_gain:
      return s.slave().workspace().force_scale();
    case Parameter::loop_gain:
      return s.master().force_feedback().has_closed_loop()
                 ? s.master().force_feedback().closed_loop().force().kp()
                 : 0;
    case Parameter::round_trip: {
      const AxisModel m = axis_model(scene, surface);
      return seconds(m.to_slave + m.to_master);
    }
    case Parameter::device_mass:
      return s.master().sim_hand().device_mass_kg();
    case Parameter::hand_mass:
      return s.master().sim_hand().has_operator_()
                 ? s.master().sim_hand().operator_().hand_mass_kg()
                 : 0;
  }
  return 0;
}

Scene with(Scene scene, int surface, Parameter p, double value) {
  proto::Scene& s = scene.proto;
  switch (p) {
    case Parameter::wall_stiffness:
      surface_of(s, surface)->set_stiffness_newton_per_m(value);
      break;
    case Parameter::reflection_gain:
      s.mutable_slave()->mutable_workspace()->set_force_scale(value);
      break;
    case Parameter::loop_gain:
      set_loop_gain(*s.mutable_master(), value);
      break;
    case Parameter::round_trip:
      for (auto* way :
           {s.mutable_link()->mutable_to_slave(), s.mutable_link()->mutable_to_master()})
        way->set_delay_ms(value * 1e3 / 2), way->set_jitter_ms(0);
      break;
    case Parameter::device_mass:
      set_device_mass(*s.mutable_master(), value);
      break;
    case Parameter::hand_mass:
      s.mutable_master()->mutable_sim_hand()->mutable_operator_()->set_hand_mass_kg(value);
      break;
  }
  return scene;
}

double radius(const AxisModel& model) {
  return spectral_radius(loop_matrices(AxisPeriod(model)).closed());
}

StabilityLimit nearest_limit(const std::function<bool(double)>& stable, double start, double least,
                             double most) {
  const bool beyond = !stable(start);
  double good = start, bad = start;
  if (beyond) {
    do {
      bad = good;
      good /= kStride;
      if (good < least) return {.value = 0, .beyond = true};
    } while (!stable(good));
  } else {
    do {
      good = bad;
      bad *= kStride;
      if (bad > most) return {.value = std::numeric_limits<double>::infinity()};
    } while (stable(bad));
  }
  while (bad > (1 + kExact) * good) {
    const double middle = std::sqrt(good * bad);
    (stable(middle) ? good : bad) = middle;
  }
  return {.value = good, .beyond = beyond};
}

StabilityLimit predicted_limit(const Scene& scene, int surface, Parameter p) {
  const Range within = range(p);
  const auto stable = [&](double value) {
    return radius(axis_model(with(scene, surface, p, value), surface)) < 1;
  };
  return nearest_limit(stable, std::max(get(scene, surface, p), within.least), within.least,
                       within.most);
}

}  // namespace farhand
