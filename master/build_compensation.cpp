#include "master/build_compensation.hpp"

#include <spdlog/fmt/fmt.h>

#include "common/scene_compensation.hpp"

namespace farhand {
namespace {

std::optional<DampedRotationConfig> damped_rotation(const proto::Scene& scene, double Ts) {
  if (!couples_rotation(scene)) return {};
  const proto::DampedCompensation& d = damped(scene);
  DampedRotationConfig c;
  c.tilt =
      damped_port(d.rotation_stiffness_newton_m_per_rad(), d.max_rotation_damping_newton_m_s(), Ts);
  c.twist = damped_port(d.twist_stiffness_newton_m_per_rad(), d.max_twist_damping_newton_m_s(), Ts);
  c.max_torque = scene.master().force_feedback().max_torque_newton_meter();
  c.guard.Ts = Ts;
  return c;
}

// Without its rotation.
DampedCouplingConfig damped_coupling(const proto::Scene& scene, double Ts) {
  DampedCouplingConfig c;
  c.translation = damped_translation(damped(scene), Ts);
  c.max_force = scene.master().force_feedback().max_force_newton();
  c.guard.Ts = Ts;
  return c;
}

// Without its rotation.
MediatedCouplingConfig mediated_coupling(const proto::Scene& scene, double Ts) {
  const proto::MediatedCompensation& m = mediated(scene);
  MediatedCouplingConfig c;
  c.renderer = {.Ts = Ts, .agree_time = m.agree_ms() * 1e-3, .drag = m.drag_newton_s_per_m()};
  c.tank.cap = m.max_tank_joule();
  c.max_force = scene.master().force_feedback().max_force_newton();
  return c;
}

ChosenCouplingConfig chosen_coupling(const proto::Scene& scene, double Ts) {
  const proto::AutoCompensation& a = scene.compensation().auto_();
  ChosenCouplingConfig c;
  c.choice = {.device_damping = a.device_damping_newton_s_per_m(),
              .stiffest = a.stiffest_newton_per_m() * handle_terms(scene)};
  c.delay.Ts = Ts;
  c.damped = damped_coupling(scene, Ts);
  c.mediated = mediated_coupling(scene, Ts);
  c.rotation = damped_rotation(scene, Ts);
  return c;
}

WaveCouplingConfig wave_coupling(const proto::Scene& scene, double Ts) {
  WaveCouplingConfig c;
  c.translation = wave_translation(scene.compensation().wave(), Ts);
  c.max_force = scene.master().force_feedback().max_force_newton();
  c.rotation = damped_rotation(scene, Ts);
  return c;
}

DirectCouplingConfig direct_coupling(const proto::Scene& scene, double Ts) {
  const proto::ForceFeedback& f = scene.master().force_feedback();
  DirectCouplingConfig c;
  c.max_force = f.max_force_newton();
  c.max_torque = f.max_torque_newton_meter();
  c.translation.Ts = Ts;
  c.translation.returns_surplus = true;
  if (!couples_rotation(scene)) return c;
  c.rotation = DampedRotationConfig{}.guard;
  c.rotation->Ts = Ts;
  c.rotation->returns_surplus = true;
  return c;
}

// What the scene says of the robot, in the handle's terms.
SmithCouplingConfig smith_coupling(const proto::Scene& scene, double Ts) {
  const proto::SmithCompensation& m = scene.compensation().smith();
  const double scales = handle_terms(scene);
  SmithCouplingConfig c;
  c.model = {.Ts = Ts,
             .share = m.model_share(),
             .mass = m.robot_mass_kg() * scales,
             .Kp = m.servo_stiffness_newton_per_m() * scales,
             .Kd = m.servo_damping_newton_s_per_m() * scales};
  c.max_force = scene.master().force_feedback().max_force_newton();
  c.guard.Ts = Ts;
  c.rotation = damped_rotation(scene, Ts);
  return c;
}

}  // namespace

std::optional<CompensatedForceConfig> compensated_force(const proto::Scene& scene, double Ts) {
  if (!scene.has_compensation()) return {};
  using C = proto::Compensation;
  switch (scene.compensation().method_case()) {
    case C::kAuto:
      return chosen_coupling(scene, Ts);
    case C::kDirect:
      return direct_coupling(scene, Ts);
    case C::kWave:
      return wave_coupling(scene, Ts);
    case C::kSmith:
      return smith_coupling(scene, Ts);
    default:
      break;
  }
  const auto with_rotation = [&](auto c) {
    c.rotation = damped_rotation(scene, Ts);
    return CompensatedForceConfig(c);
  };
  if (scene.compensation().has_mmt()) return with_rotation(mediated_coupling(scene, Ts));
  return with_rotation(damped_coupling(scene, Ts));
}

std::string compensated_force_stage(const proto::Scene& scene) {
  const proto::Compensation& c = scene.compensation();
  if (c.has_auto_())
    return "compensation      auto: direct, damped or mmt, by delay and what is known of the wall";
  if (c.has_mmt())
    return fmt::format(
        "compensation      mmt: the slave's wall rendered here, at most {:g} N/m, from a tank",
        c.mmt().max_stiffness_newton_per_m());
  if (c.has_damped())
    return fmt::format(
        "compensation      damped: {:g} N/m to the robot's place{}, damped by the delay, guarded",
        c.damped().stiffness_newton_per_m(), c.damped().has_touch() ? " in contact" : "");
  if (c.has_wave())
    return fmt::format(
        "compensation      wave: {:g} N s/m, through a playout buffer of at most {:g} ms",
        c.wave().impedance_newton_s_per_m(), c.wave().max_playout_ms());
  if (c.has_smith())
    return fmt::format(
        "compensation      smith: {:g} kg behind {:g} N/m and the registered wall, guarded",
        c.smith().robot_mass_kg(), c.smith().servo_stiffness_newton_per_m());
  const proto::ForceFeedback& f = scene.master().force_feedback();
  return fmt::format("compensation      {}hold {:g} ms, fade {:g} ms",
                     c.has_direct() ? "direct, guarded: " : "", f.hold_ms(), f.fade_ms());
}

}  // namespace farhand
