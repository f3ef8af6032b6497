#include "master/build_sim_hand.hpp"

#include "common/scene_values.hpp"
#include "master/build_ahrs.hpp"
#include "master/build_values.hpp"

namespace farhand {
namespace {

PlantConfig plant(const proto::SimHand& h) {
  return {.mass = h.device_mass_kg(),
          .damping = h.device_damping_newton_s_per_m(),
          .friction = h.device_friction_newton(),
          .weight = h.device_weight_newton(),
          .rotation_inertia = h.rotation_inertia_kg_m2(),
          .rotation_damping = h.rotation_damping_newton_m_s(),
          .rotation_friction = h.rotation_friction_newton_m(),
          .twist_inertia = h.twist_inertia_kg_m2(),
          .twist_damping = h.twist_damping_newton_m_s()};
}

HandImpedance impedance(const proto::Operator& o) {
  return {.mass = o.hand_mass_kg(),
          .stiffness = o.stiffness_newton_per_m(),
          .damping = o.damping_newton_s_per_m(),
          .rotation_stiffness = o.rotation_stiffness_newton_m_per_rad(),
          .rotation_damping = o.rotation_damping_newton_m_s(),
          .twist_stiffness = o.twist_stiffness_newton_m_per_rad(),
          .twist_damping = o.twist_damping_newton_m_s()};
}

Vec3 radians3(const Vec3& degrees) {
  return degrees * radians(1);
}

TraceConfig trace_config(const proto::Trace& t, const std::string& file) {
  return {.file = file,
          .scale = t.scale(),
          .reach = t.reach_m(),
          .rotation_scale = t.rotation_scale(),
          .max_tilt = radians(t.max_tilt_deg())};
}

MotionConfig motion(const Scene& scene, const proto::Motion& m,
                    const std::optional<std::string>& trace) {
  MotionConfig c{.limits = {.speed = m.max_speed_m_per_s(),
                            .turn_rate = radians(m.max_turn_rate_deg_per_s())}};
  if (trace) {
    c.trace = trace_config(m.trace(), *trace);
    return c;
  }
  if (m.has_trace()) {
    if (m.trace().file().empty())
      throw std::runtime_error(
          scene.path +
          " moves the hand by a trace and names no file: give --trace FILE, or "
          "say file: in its trace");
    c.trace = trace_config(m.trace(), beside(scene, m.trace().file()));
  }
  for (const auto& s : m.sine())
    c.sines.push_back({.from = s.from_s(),
                       .until = s.until_s(),
                       .frequency = s.frequency_hz(),
                       .offset = vec3(s.amplitude_m()),
                       .turn = radians3(vec3(s.amplitude_deg()))});
  for (const auto& r : m.reach())
    c.reaches.push_back({.at = r.at_s(),
                         .lasting = r.lasting_s(),
                         .by = vec3(r.by_m()),
                         .turn = radians3(vec3(r.turn_deg()))});
  return c;
}

std::vector<Press> presses(const proto::Operator& o) {
  if (o.press().empty()) return {Press{}};
  std::vector<Press> out;
  for (const auto& p : o.press())
    out.push_back({.button = p.button() == proto::Press::CLUTCH ? Button::clutch : Button::dead_man,
                   .at = p.at_s(),
                   .lasting = p.lasting_s()});
  return out;
}

}  // namespace

SimHandConfig sim_hand_config(const Scene& scene, const std::optional<std::string>& trace) {
  const proto::SimHand& h = scene.proto.master().sim_hand();
  SimHandConfig c{.device = plant(h)};
  if (h.has_operator_()) {
    c.user = OperatorConfig{impedance(h.operator_()), motion(scene, h.operator_().motion(), trace)};
    c.presses = presses(h.operator_());
  } else {
    if (trace)
      throw std::runtime_error(scene.path +
                               " has no master.sim_hand.operator whose motion --trace could give");
    c.presses.clear();
  }
  for (const auto& p : h.push())
    c.pushes.push_back({p.at_s(), p.lasting_s(), vec3(p.force_newton())});
  if (h.start_position_m_size() == 3) c.start_p_MH = vec3(h.start_position_m());
  c.encoder_step = h.encoder_step_rad();
  c.force_noise = h.force_noise_newton();
  c.sensor_bias = end_forces(h.sensor_bias_newton());
  c.grip_mass = h.grip_mass_kg();
  c.motor_gain = h.motor_gain();
  c.rate = h.rate_hz();
  const proto::Ahrs& ahrs = scene.proto.master().ahrs();
  if (ahrs.has_simulated()) c.ahrs = sim_ahrs_config(ahrs);
  return c;
}

}  // namespace farhand
