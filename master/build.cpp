#include "master/build.hpp"

#include <spdlog/fmt/fmt.h>

#include <filesystem>

#include "common/scene_bilateral.hpp"
#include "common/scene_realtime.hpp"
#include "common/scene_values.hpp"
#include "master/build_ahrs.hpp"
#include "master/build_compensation.hpp"
#include "master/build_falcon.hpp"
#include "master/build_force.hpp"
#include "master/build_sim_hand.hpp"
#include "master/build_values.hpp"

namespace farhand {
namespace {

TwinDeltaGeometry twin_delta(const proto::TwinDelta& t) {
  TwinDeltaGeometry g = kTwinDelta;
  g.k = t.twist_lever_m();
  return g;
}

double max_motor_torque(const proto::Master& m) {
  return m.has_falcon() ? m.falcon().max_motor_torque_newton_meter()
                        : m.twin_delta().max_motor_torque_newton_meter();
}

RobotCouplingConfig robot_coupling(const proto::RobotCoupling& c) {
  return {.stiffness = c.stiffness_newton_per_m(),
          .damping = c.damping_newton_s_per_m(),
          .rotation_stiffness = c.rotation_stiffness_newton_m_per_rad(),
          .rotation_damping = c.rotation_damping_newton_m_s(),
          .twist_stiffness = c.twist_stiffness_newton_m_per_rad(),
          .twist_damping = c.twist_damping_newton_m_s()};
}

// Not with a deadband: an answer awaited may never come.
bool answers_every_tick(const proto::Scene& scene) {
  return !scene.link().has_deadband();
}

PositionControlConfig position_control(const proto::PositionControl& p, double Ts) {
  PositionControlConfig c{.pid = {.kp = p.kp_newton_per_m(),
                                  .ki = p.ki_newton_per_m_s(),
                                  .kd = p.kd_newton_s_per_m(),
                                  .limit = p.max_force_newton(),
                                  .derivative_cutoff_hz = p.derivative_cutoff_hz()},
                          .max_force = p.max_force_newton(),
                          .gravity_mass = p.gravity_mass_kg()};
  for (const auto& s : p.set_point())
    c.set_points.push_back({from_seconds(s.at_s()), vec3(s.position_m())});
  if (p.max_speed_m_per_s() > 0)
    c.safe = {.max_speed = p.max_speed_m_per_s(),
              .force_step = p.max_force_rate_newton_per_s() * Ts};
  if (p.has_park()) c.park_p_MH = vec3(p.park().position_m());
  if (p.has_danger_cue()) {
    const proto::DangerCue& cue = p.danger_cue();
    c.danger_cue = {.max_shift = cue.max_shift_m(),
                    .shift_step = cue.speed_m_per_s() * Ts,
                    .contact = cue.contact_newton()};
    for (const auto& d : cue.danger())
      c.danger_cue->script.push_back(
          {from_seconds(d.at_s()), from_seconds(d.lasting_s()), vec3(d.towards())});
  }
  return c;
}

Fixture fixture(const proto::Fixture& f) {
  Fixture c{.stiffness = f.stiffness_newton_per_m(),
            .damping = f.damping_newton_s_per_m(),
            .max_force = f.max_force_newton()};
  if (f.has_axis())
    c.shape = AxisFixture{vec3(f.axis().point_m()), vec3(f.axis().direction()).normalized()};
  else if (f.has_sphere())
    c.shape = SphereFixture{.centre_M = vec3(f.sphere().centre_m()),
                            .radius = f.sphere().radius_m(),
                            .keep = f.sphere().keep() == proto::FixtureSphere::INSIDE
                                        ? SphereFixture::Keep::inside
                                    : f.sphere().keep() == proto::FixtureSphere::OUTSIDE
                                        ? SphereFixture::Keep::outside
                                        : SphereFixture::Keep::attract};
  else
    c.shape = PlaneFixture{.point_M = vec3(f.plane().point_m()),
                           .normal_M = vec3(f.plane().normal()).normalized(),
                           .two_sided = f.plane().two_sided()};
  return c;
}

GuidanceConfig guidance(const proto::Guidance& g) {
  GuidanceConfig c;
  for (const auto& f : g.fixture()) c.fixtures.push_back(fixture(f));
  if (g.has_handle_limits())
    c.handle_limits = {.margin = g.handle_limits().margin_m(),
                       .max_force = g.handle_limits().max_force_newton()};
  return c;
}

std::string position_control_stage(const proto::PositionControl& p) {
  std::string out = fmt::format("position_control  PID, set points: {}, at most {:g} N",
                                p.set_point_size(), p.max_force_newton());
  if (p.max_speed_m_per_s() > 0) out += fmt::format(" and {:g} m/s", p.max_speed_m_per_s());
  if (p.has_park()) out += ", parks";
  if (p.has_danger_cue())
    out += fmt::format(", danger cue up to {:g} mm", 1e3 * p.danger_cue().max_shift_m());
  if (p.danger_cue().contact_newton() > 0)
    out += fmt::format(" at a contact of {:g} N", p.danger_cue().contact_newton());
  return out;
}

}  // namespace

MasterConfig master_config(const proto::Scene& scene) {
  const proto::Master& m = scene.master();
  MasterConfig c{.Ts = 1 / scene.rate_hz(),
                 .stale = milliseconds(scene.link().stale_ms()),
                 .velocity_cutoff_hz = m.velocity_cutoff_hz(),
                 .max_motor_torque = max_motor_torque(m)};
  if (m.has_falcon())
    c.handle = FalconHandle{.geometry = falcon_geometry(m.falcon())};
  else
    c.handle = TwinDeltaHandle{.geometry = twin_delta(m.twin_delta())};
  if (m.has_ahrs()) c.grip_motion = grip_motion_config(m.ahrs(), c.Ts);
  if (m.has_force_sensing())
    c.force_sensing = {.bias = end_forces(m.force_sensing().bias_newton()),
                       .grip_mass = m.force_sensing().grip_mass_kg()};
  if (m.has_force_feedback()) c.force_feedback = force_feedback_config(m, c.Ts);
  if (scene.slave().workspace().has_alignment_deg())
    c.alignment = radians(scene.slave().workspace().alignment_deg());
  const Channels ch = channels(scene);
  c.reflects_contact = ch.contact_force && !scene.has_compensation();
  c.sends_user_wrench = ch.user_force;
  c.compensated = compensated_force(scene, c.Ts);
  if (ch.robot_position) c.robot_coupling = robot_coupling(coupling(scene.bilateral()));
  if (m.has_position_control()) c.position_control = position_control(m.position_control(), c.Ts);
  if (m.has_guidance()) c.guidance = guidance(m.guidance());
  return c;
}

MasterLoopConfig master_loop_config(const proto::Scene& scene) {
  return {.period = from_seconds(1 / scene.rate_hz()),
          .cut_off = answers_every_tick(scene) ? from_seconds(scene.link().cut_off_us() * 1e-6)
                                               : Duration::zero(),
          .lost = milliseconds(scene.link().lost_ms()),
          .spin = realtime_config(scene.master().realtime()).spin,
          .park = from_seconds(scene.master().position_control().park().at_end_s())};
}

AnyDevice make_device(const Scene& scene, const std::optional<std::string>& trace,
                      std::uint64_t seed) {
  const proto::Master& m = scene.proto.master();
  if (m.has_falcon_usb()) {
    if (trace) throw std::runtime_error("--trace moves a simulated hand, and this scene has none");
    return AnyDevice(std::in_place_type<FalconUsb>, falcon_usb_config(scene));
  }
  SimHandConfig c = sim_hand_config(scene, trace);
  c.seed = seed;
  c.max_motor_torque = max_motor_torque(m);
  if (m.has_falcon())
    return AnyDevice(std::in_place_type<SimHand<FalconGeometry>>, falcon_geometry(m.falcon()),
                     std::move(c));
  return AnyDevice(std::in_place_type<SimHand<TwinDeltaGeometry>>, twin_delta(m.twin_delta()),
                   std::move(c));
}

std::vector<std::string> master_stages(const proto::Scene& scene) {
  const proto::Master& m = scene.master();
  const char* handle = m.has_falcon() ? "falcon" : "twin_delta";
  std::vector<std::string> out;
  out.push_back(fmt::format("device            read {} at {:g} Hz{}{}",
                            m.has_falcon_usb() ? "falcon_usb" : "sim_hand", scene.rate_hz(),
                            m.falcon_usb().has_calibration() ? ", calibrated as " : "",
                            m.falcon_usb().calibration()));
  out.push_back(fmt::format("handle            {}: forward kinematics{}", handle,
                            m.has_ahrs() ? "" : ", velocity"));
  if (m.has_ahrs()) out.push_back(ahrs_stage(m.ahrs()));
  if (m.has_force_sensing())
    out.push_back(
        fmt::format("force_sensing     user's wrench from both ends, bias and {:g} kg removed",
                    m.force_sensing().grip_mass_kg()));
  if (scene.has_slave())
    out.push_back(std::string("link              send the handle's pose; ") +
                  (answers_every_tick(scene) ? "await the answer" : "take the newest answer"));
  if (m.has_force_feedback()) {
    out.push_back(compensated_force_stage(scene));
    if (channels(scene).robot_position)
      out.push_back(fmt::format("robot_coupling    {:g} N/m to the robot's position",
                                coupling(scene.bilateral()).stiffness_newton_per_m()));
    if (m.has_guidance())
      out.push_back(fmt::format("guidance          fixtures: {}{}", m.guidance().fixture_size(),
                                m.guidance().has_handle_limits() ? ", handle limits" : ""));
    for (std::string& line : force_stages(m)) out.push_back(std::move(line));
  }
  if (m.has_position_control()) out.push_back(position_control_stage(m.position_control()));
  if (m.has_force_feedback() || m.has_position_control())
    out.push_back(
        fmt::format("limits            finite, clamp, slew; write motor torques, at most {:g} N m",
                    max_motor_torque(m)));
  return out;
}

}  // namespace farhand
