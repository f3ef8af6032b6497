#include "master/build.hpp"

#include <spdlog/fmt/fmt.h>

#include <filesystem>

#include "common/scene_values.hpp"
#include "master/build_force.hpp"
#include "master/build_sim_hand.hpp"
#include "master/build_values.hpp"

namespace farhand {
namespace {

FalconGeometry falcon(const proto::Falcon& f) {
  FalconGeometry g = kFalconTable1;
  switch (f.geometry()) {
    case proto::Falcon::TABLE1:
      break;
    case proto::Falcon::TABLE1_S0:
      g = kFalconTable1S0;
      break;
    case proto::Falcon::TABLE1_FLIP:
      g = kFalconTable1Flip;
      break;
    case proto::Falcon::LIBNIFALCON:
      g = kFalconLibnifalcon;
      break;
  }
  if (f.has_gear_ratio()) g.gear_ratio = f.gear_ratio();
  if (f.has_angle_offset_deg()) g.angle_offset = radians(f.angle_offset_deg());
  return g;
}

TwinDeltaGeometry twin_delta(const proto::TwinDelta& t) {
  TwinDeltaGeometry g = kTwinDelta;
  g.k = t.twist_lever_m();
  return g;
}

double max_motor_torque(const proto::Master& m) {
  return m.has_falcon() ? m.falcon().max_motor_torque_newton_meter()
                        : m.twin_delta().max_motor_torque_newton_meter();
}

PositionControlConfig position_control(const proto::PositionControl& p) {
  PositionControlConfig c{.pid = {.kp = p.kp_newton_per_m(),
                                  .ki = p.ki_newton_per_m_s(),
                                  .kd = p.kd_newton_s_per_m(),
                                  .limit = p.max_force_newton(),
                                  .derivative_cutoff_hz = p.derivative_cutoff_hz()},
                          .max_force = p.max_force_newton(),
                          .gravity_mass = p.gravity_mass_kg()};
  for (const auto& s : p.set_point())
    c.set_points.push_back({from_seconds(s.at_s()), vec3(s.position_m())});
  return c;
}

}  // namespace

MasterConfig master_config(const proto::Scene& scene) {
  const proto::Master& m = scene.master();
  MasterConfig c{.Ts = 1 / scene.rate_hz(),
                 .stale = milliseconds(scene.link().stale_ms()),
                 .velocity_cutoff_hz = m.velocity_cutoff_hz(),
                 .max_motor_torque = max_motor_torque(m)};
  if (m.has_falcon())
    c.handle = FalconHandle{.geometry = falcon(m.falcon())};
  else
    c.handle = TwinDeltaHandle{.geometry = twin_delta(m.twin_delta())};
  if (m.has_force_sensing())
    c.force_sensing = {.bias = end_forces(m.force_sensing().bias_newton()),
                       .grip_mass = m.force_sensing().grip_mass_kg()};
  if (m.has_force_feedback()) c.force_feedback = force_feedback_config(m, c.Ts);
  if (m.has_position_control()) c.position_control = position_control(m.position_control());
  return c;
}

MasterLoopConfig master_loop_config(const proto::Scene& scene) {
  return {.period = from_seconds(1 / scene.rate_hz()),
          .cut_off = from_seconds(scene.link().cut_off_us() * 1e-6),
          .lost = milliseconds(scene.link().lost_ms())};
}

AnyDevice make_device(const Scene& scene, const std::optional<std::string>& trace,
                      std::uint64_t seed) {
  const proto::Master& m = scene.proto.master();
  SimHandConfig c = sim_hand_config(scene, trace);
  c.seed = seed;
  c.max_motor_torque = max_motor_torque(m);
  if (m.has_falcon())
    return AnyDevice(std::in_place_type<SimHand<FalconGeometry>>, falcon(m.falcon()), std::move(c));
  return AnyDevice(std::in_place_type<SimHand<TwinDeltaGeometry>>, twin_delta(m.twin_delta()),
                   std::move(c));
}

std::vector<std::string> master_stages(const proto::Scene& scene) {
  const proto::Master& m = scene.master();
  const char* handle = m.has_falcon() ? "falcon" : "twin_delta";
  std::vector<std::string> out;
  out.push_back(fmt::format("device            read sim_hand at {:g} Hz", scene.rate_hz()));
  out.push_back(fmt::format("handle            {}: forward kinematics, velocity", handle));
  if (m.has_force_sensing())
    out.push_back(
        fmt::format("force_sensing     user's wrench from both ends, bias and {:g} kg removed",
                    m.force_sensing().grip_mass_kg()));
  if (scene.has_slave())
    out.push_back("link              send the handle's pose; await the answer");
  if (m.has_force_feedback()) {
    out.push_back(fmt::format("compensation      hold {:g} ms, fade {:g} ms",
                              m.force_feedback().hold_ms(), m.force_feedback().fade_ms()));
    for (std::string& line : force_stages(m)) out.push_back(std::move(line));
  }
  if (m.has_position_control())
    out.push_back(fmt::format("position_control  PID, set points: {}, at most {:g} N",
                              m.position_control().set_point_size(),
                              m.position_control().max_force_newton()));
  if (m.has_force_feedback() || m.has_position_control())
    out.push_back(
        fmt::format("limits            finite, clamp, slew; write motor torques, at most {:g} N m",
                    max_motor_torque(m)));
  return out;
}

}  // namespace farhand
