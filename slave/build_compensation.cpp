#include "slave/build_compensation.hpp"

#include <spdlog/fmt/fmt.h>

#include <algorithm>

#include "common/scene_compensation.hpp"
#include "common/scene_values.hpp"

namespace farhand {
namespace {

// The target's greatest speed, in the handle's terms [m/s].
double handle_speed(const SlaveConfig& slave) {
  return slave.workspace.position_step / slave.Ts / slave.workspace.scale;
}

std::optional<DampedTurnConfig> damped_turn(const proto::Scene& scene, const SlaveConfig& slave) {
  if (!couples_rotation(scene)) return {};
  const proto::DampedCompensation& d = damped(scene);
  DampedTurnConfig c;
  c.spring = damped_port(d.rotation_stiffness_newton_m_per_rad(),
                         d.max_rotation_damping_newton_m_s(), slave.Ts);
  c.inertia.mass = d.virtual_inertia_kg_m2();
  c.inertia.max_speed = slave.workspace.rotation_step / slave.Ts;
  c.inertia.Ts = c.guard.Ts = slave.Ts;
  return c;
}

// Without its rotation.
DampedTargetConfig damped_target(const proto::Scene& scene, const SlaveConfig& slave) {
  const proto::DampedCompensation& d = damped(scene);
  DampedTargetConfig c;
  c.translation = damped_translation(d, slave.Ts);
  c.mass.mass = d.virtual_mass_kg();
  c.mass.contact_damping = d.contact_damping_newton_s_per_m();
  c.mass.max_speed = handle_speed(slave);
  c.mass.Ts = c.guard.Ts = slave.Ts;
  return c;
}

// Without its rotation. What the scene says of the robot, in the handle's terms.
MediatedTargetConfig mediated_target(const proto::Scene& scene, const SlaveConfig& slave) {
  const proto::MediatedCompensation& m = mediated(scene);
  const double force_scale = slave.workspace.force_scale, scales = handle_terms(scene);
  MediatedTargetConfig c;
  c.finder.Ts = c.finder.estimate.Ts = slave.Ts;
  c.finder.servo_stiffness = m.servo_stiffness_newton_per_m() * scales;
  c.finder.feared_stiffness *= scales;
  c.finder.max_stiffness = m.max_stiffness_newton_per_m();
  c.finder.touch = m.contact_newton() * force_scale;
  c.finder.miss_felt = std::min(c.finder.miss_felt, 0.4 * c.finder.touch);
  c.finder.max_force = m.max_contact_newton() * force_scale;
  return c;
}

WaveTargetConfig wave_target(const proto::Scene& scene, const SlaveConfig& slave) {
  const proto::WaveCompensation& w = scene.compensation().wave();
  WaveTargetConfig c;
  c.translation = wave_translation(w, slave.Ts);
  c.servo_stiffness = w.servo_stiffness_newton_per_m() * handle_terms(scene);
  c.mass = {.Ts = slave.Ts,
            .mass = w.virtual_mass_kg(),
            .contact_damping = w.contact_damping_newton_s_per_m(),
            .max_speed = handle_speed(slave)};
  c.rotation = damped_turn(scene, slave);
  return c;
}

DirectTargetConfig direct_target(const proto::Scene& scene, const SlaveConfig& slave) {
  const proto::DirectCompensation& d = scene.compensation().direct();
  const double force_scale = slave.workspace.force_scale;
  const Duration conceal = milliseconds(d.conceal_ms());
  DirectTargetConfig c;
  c.max_speed = handle_speed(slave);
  c.max_turn_rate = slave.workspace.rotation_step / slave.Ts;
  c.translation.Ts = slave.Ts;
  c.translation.noise = d.contact_newton() * force_scale;
  c.translation.returns_surplus = true;
  c.concealment = {.full = conceal, .fade = std::max(conceal, Duration(1))};
  if (!couples_rotation(scene)) return c;
  c.rotation = VelocityGuardConfig{.Ts = slave.Ts,
                                   .store = DampedTurnConfig{}.guard.store,
                                   .drift_speed = 0.5,
                                   .noise = d.contact_newton_meter() * force_scale,
                                   .returns_surplus = true};
  return c;
}

SmithTargetConfig smith_target(const proto::Scene& scene, const SlaveConfig& slave) {
  const proto::RegisteredWall& w = scene.compensation().smith().wall();
  const double scales = handle_terms(scene);
  SmithTargetConfig c;
  c.wall.x_w = vec3(w.point_in_slave_m());
  c.wall.n = vec3(w.normal_in_slave()).normalized();
  c.wall.k = w.stiffness_newton_per_m() * scales;
  c.wall.b = w.damping_newton_s_per_m() * scales;
  c.rotation = damped_turn(scene, slave);
  return c;
}

}  // namespace

std::optional<CompensatedTargetConfig> compensated_target(const proto::Scene& scene,
                                                          const SlaveConfig& slave) {
  if (!scene.has_compensation()) return {};
  const auto turn = damped_turn(scene, slave);
  using C = proto::Compensation;
  switch (scene.compensation().method_case()) {
    case C::kAuto:
      return ChosenTargetConfig{.damped = damped_target(scene, slave),
                                .mediated = mediated_target(scene, slave),
                                .rotation = turn};
    case C::kDirect:
      return direct_target(scene, slave);
    case C::kWave:
      return wave_target(scene, slave);
    case C::kSmith:
      return smith_target(scene, slave);
    default:
      break;
  }
  const auto with_rotation = [&](auto c) {
    c.rotation = turn;
    return CompensatedTargetConfig(c);
  };
  if (scene.compensation().has_mmt()) return with_rotation(mediated_target(scene, slave));
  return with_rotation(damped_target(scene, slave));
}

std::string compensated_target_stage(const proto::Scene& scene) {
  const proto::Compensation& c = scene.compensation();
  if (c.has_auto_()) return "compensation    auto: by the method that the master names";
  if (c.has_mmt())
    return fmt::format("compensation    mmt: finds the wall, presses by at most {:g} N",
                       c.mmt().max_contact_newton());
  if (c.has_direct())
    return fmt::format("compensation    direct, guarded: the handle's pose, carried on for {:g} ms",
                       c.direct().conceal_ms());
  if (c.has_wave())
    return fmt::format("compensation    wave: {:g} kg pushed by the waves, the target",
                       c.wave().virtual_mass_kg());
  if (c.has_smith()) return "compensation    smith: the handle's poses, through a playout buffer";
  return fmt::format("compensation    damped: {:g} kg on a spring to the handle, the target",
                     c.damped().virtual_mass_kg());
}

}  // namespace farhand
