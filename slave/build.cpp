#include "slave/build.hpp"

#include <spdlog/fmt/fmt.h>

#include <algorithm>
#include <numbers>
#include <vector>

#include "common/scene_bilateral.hpp"
#include "common/scene_realtime.hpp"
#include "common/scene_values.hpp"
#include "slave/build_compensation.hpp"

namespace farhand {
namespace {

WorkspaceConfig workspace(const proto::Scene& scene) {
  const proto::Workspace& w = scene.slave().workspace();
  const double Ts = 1 / scene.rate_hz();
  const bool aligns = w.has_alignment_deg();
  return {.R_SM = scene.master().has_falcon() ? falcon_axes() : twin_delta_axes(),
          .scale = w.scale(),
          .force_scale = w.force_scale(),
          .rotation_lock = w.rotation_lock(),
          .alignment = aligns ? std::optional(radians(w.alignment_deg())) : std::nullopt,
          .position_step = w.max_tool_speed_m_per_s() * Ts,
          .rotation_step = radians(w.max_tool_turn_rate_deg_per_s()) * Ts};
}

JointServoConfig servo(const proto::JointPid& pid) {
  JointServoConfig c{.bandwidth_hz = pid.bandwidth_hz(),
                     .damping_ratio = pid.damping_ratio(),
                     .integral_per_s = pid.integral_per_s(),
                     .derivative_cutoff_hz = pid.derivative_cutoff_hz(),
                     .gravity_compensation = pid.has_gravity_compensation()};
  if (pid.has_friction_compensation())
    c.friction_compensation = {.share = pid.friction_compensation().share(),
                               .speed_scale = pid.friction_compensation().speed_scale_rad_per_s()};
  if (pid.has_velocity_feedforward()) {
    c.velocity_feedforward = {.share = pid.velocity_feedforward().share()};
    c.command_cutoff_hz = pid.velocity_feedforward().cutoff_hz();
  }
  return c;
}

BoundaryConfig boundary(const proto::Boundary& b, double Ts) {
  return {.joint_margin = radians(b.joint_margin_deg()),
          .reach_margin = b.reach_margin_m(),
          .elbow_margin = b.elbow_margin(),
          .wrist_margin = b.wrist_margin(),
          .shoulder_margin = b.shoulder_margin_m(),
          .stiffness = b.stiffness_newton_per_m(),
          .rotation_stiffness = b.rotation_stiffness_newton_m_per_rad(),
          .limits = {.force = b.max_force_newton(),
                     .torque = b.max_torque_newton_meter(),
                     .twist_torque = b.max_torque_newton_meter(),
                     .force_step = b.max_force_rate_newton_per_s() * Ts,
                     .torque_step = b.max_torque_rate_newton_meter_per_s() * Ts}};
}

Shape shape(const proto::Surface& s) {
  switch (s.shape_case()) {
    case proto::Surface::kSphere:
      return Sphere{.centre = vec3(s.sphere().centre_m()), .radius = s.sphere().radius_m()};
    case proto::Surface::kBox: {
      const Vec3 half = 0.5 * vec3(s.box().size_m());
      return Box{
          .X_SB = {rotation(Vec3(0, 0, radians(s.box().yaw_deg()))), vec3(s.box().centre_m())},
          .half_extents = half,
          .edge_radius = std::min(0.005, half.minCoeff())};
    }
    case proto::Surface::kPlane:
    case proto::Surface::SHAPE_NOT_SET:
      break;
  }
  return Plane{.point = vec3(s.plane().point_m()), .normal = vec3(s.plane().normal()).normalized()};
}

std::vector<SurfaceStep> surface_steps(const proto::SimArm& arm) {
  std::vector<SurfaceStep> out;
  for (int i = 0; i < arm.surface_size(); ++i)
    for (const proto::SurfaceStep& s : arm.surface(i).step())
      out.push_back({static_cast<std::size_t>(i), from_seconds(s.at_s()), vec3(s.by_m())});
  std::stable_sort(out.begin(), out.end(),
                   [](const SurfaceStep& a, const SurfaceStep& b) { return a.at < b.at; });
  return out;
}

SimArmConfig sim_arm(const proto::SimArm& arm) {
  SimArmConfig c{.rate_hz = arm.rate_hz(), .friction = arm.friction(), .q = kTeleopHome};
  c.encoder_quantum_rad = arm.encoder_step_rad();
  if (arm.start_deg_size() == 6)
    for (int i = 0; i < 6; ++i) c.q[i] = radians(arm.start_deg(i));
  c.tip_radius_m = arm.tip_radius_m();
  for (const auto& s : arm.surface())
    c.surfaces.items[c.surfaces.count++] = {.shape = shape(s),
                                            .stiffness = s.stiffness_newton_per_m(),
                                            .damping = s.damping_newton_s_per_m(),
                                            .friction = s.friction_coefficient(),
                                            .tangential_stiffness = s.stiffness_newton_per_m(),
                                            .tangential_damping = s.damping_newton_s_per_m()};
  c.surface_steps = surface_steps(arm);
  const proto::SimForceSensor& sensor = arm.force_sensor();
  if (arm.has_force_sensor())
    c.sensor = {.force_noise_newton = sensor.force_noise_newton(),
                .torque_noise_newton_metre = sensor.torque_noise_newton_meter(),
                .bias_E = {vec3(sensor.bias_newton()), Vec3::Zero()},
                .tool_mass_kg = sensor.tool_mass_kg(),
                .tool_com_E = vec3(sensor.tool_com_m())};
  return c;
}

AnswerDeadbandConfig deadband(const proto::ForceDeadband& d) {
  DeadbandConfig force{
      .share = d.share(), .floor = d.floor_newton(), .keep_alive = milliseconds(d.keep_alive_ms())};
  DeadbandConfig torque = force;
  torque.floor = d.floor_newton_meter();
  return {force, torque};
}

// What the bilateral architecture sends and takes.
void add_channels(const proto::Scene& scene, SlaveConfig& c) {
  c.sends_robot = channels(scene).robot_position || scene.has_compensation();
  c.compensated = compensated_target(scene, c);
  if (scene.bilateral().has_force_position()) {
    const proto::ForcePosition& f = scene.bilateral().force_position();
    c.admittance = {.Ts = c.Ts,
                    .mass = f.virtual_mass_kg(),
                    .damping = f.virtual_damping_newton_s_per_m(),
                    .inertia = f.virtual_inertia_kg_m2(),
                    .rotation_damping = f.virtual_rotation_damping_newton_m_s(),
                    .max_speed = c.workspace.position_step / c.Ts,
                    .max_turn_rate = c.workspace.rotation_step / c.Ts};
  }
  if (scene.bilateral().has_force_force()) {
    const proto::ForceForce& f = scene.bilateral().force_force();
    c.user_force = {.share = f.user_force_share(),
                    .max_force = f.max_user_force_newton(),
                    .max_torque = f.max_user_torque_newton_meter()};
  }
}

}  // namespace

SlaveConfig slave_config(const proto::Scene& scene) {
  const proto::Slave& slave = scene.slave();
  SlaveConfig c{.Ts = 1 / scene.rate_hz(),
                .stale = milliseconds(scene.link().stale_ms()),
                .workspace = workspace(scene),
                .servo = servo(slave.joint_pid())};
  if (slave.has_force_sensing()) {
    const proto::ForceSensing& f = slave.force_sensing();
    c.force_sensing = {.tool_mass = f.tool_mass_kg(),
                       .p_ET = vec3(f.tool_com_m()),
                       .bias = vec3(f.bias_newton()),
                       .cutoff_hz = f.cutoff_hz()};
  }
  add_channels(scene, c);
  if (scene.link().has_deadband()) c.deadband = deadband(scene.link().deadband());
  if (slave.has_boundary()) c.boundary = boundary(slave.boundary(), c.Ts);
  return c;
}

SlaveLoopConfig slave_loop_config(const proto::Scene& scene) {
  return {.period = from_seconds(1 / scene.rate_hz()),
          .lost = milliseconds(scene.link().lost_ms()),
          .spin = realtime_config(scene.slave().realtime()).spin};
}

AnyRobot make_robot(const proto::Scene& scene, std::uint64_t seed) {
  SimArmConfig c = sim_arm(scene.slave().sim_arm());
  c.seed = seed;
  return SimArm(c);
}

std::vector<std::string> slave_stages(const proto::Scene& scene) {
  const proto::Slave& s = scene.slave();
  const proto::JointPid& pid = s.joint_pid();
  std::vector<std::string> out;
  out.push_back(fmt::format("link            receive the handle's pose at {:g} Hz, phase-locked",
                            scene.rate_hz()));
  if (scene.bilateral().has_force_position())
    out.push_back(fmt::format("admittance      the user's force moves {:g} kg, the target",
                              scene.bilateral().force_position().virtual_mass_kg()));
  if (scene.has_compensation()) out.push_back(compensated_target_stage(scene));
  const proto::Workspace& w = s.workspace();
  out.push_back(fmt::format("workspace       handle pose to tool target, scale {:g}{}{}", w.scale(),
                            w.rotation_lock() ? ", orientation kept" : "",
                            w.has_alignment_deg()
                                ? fmt::format(", coupled again within {:g} deg", w.alignment_deg())
                                : ""));
  out.push_back(fmt::format("robot           read sim_arm ({:g} Hz Runge-Kutta, surfaces: {})",
                            s.sim_arm().rate_hz(), s.sim_arm().surface_size()));
  out.push_back("arm             forward and nearest inverse kinematics");
  if (s.has_boundary())
    out.push_back(
        fmt::format("boundary        slides along the robot's limits; felt by at most {:g} N",
                    s.boundary().max_force_newton()));
  out.push_back(fmt::format("joint_pid       {:g} Hz, damping {:g}{}{}{}", pid.bandwidth_hz(),
                            pid.damping_ratio(), pid.has_gravity_compensation() ? ", gravity" : "",
                            pid.has_friction_compensation() ? ", friction" : "",
                            pid.has_velocity_feedforward() ? ", velocity feed-forward" : ""));
  if (scene.bilateral().has_force_force())
    out.push_back(fmt::format("user_force      pushes the arm, share {:g}",
                              scene.bilateral().force_force().user_force_share()));
  out.push_back("limits          finite, clamp, slew; write joint torques");
  if (s.has_force_sensing())
    out.push_back(
        "force_sensing   contact wrench, tool weight and bias removed, sent to the master");
  out.push_back(std::string("link            send the tool's pose") +
                (channels(scene).robot_position || scene.has_compensation()
                     ? ", also as a handle pose"
                     : "") +
                (scene.link().has_deadband() ? ", where it tells something new" : ""));
  return out;
}

}  // namespace farhand
