#include "tests/loop/stability/axis.hpp"

#include <stdexcept>

#include "common/impairment.hpp"
#include "common/scene_values.hpp"
#include "master/build.hpp"
#include "master/build_sim_hand.hpp"
#include "slave/build.hpp"
#include "slave/contact.hpp"

namespace farhand {
namespace {

SimArmConfig arm_config(const proto::Scene& scene) {
  const AnyRobot robot = make_robot(scene, 1);
  return std::get<SimArm>(robot).config();
}

// What the hand wishes does not matter to stability, and a trace may not be at hand.
HandAxis hand_axis(const Scene& scene) {
  Scene resting = scene;
  resting.proto.mutable_master()->mutable_sim_hand()->mutable_operator_()->clear_motion();
  const SimHandConfig c = sim_hand_config(resting, {});
  const bool held = scene.proto.master().sim_hand().has_operator_();
  return {.device = c.device, .hand = held ? c.user->impedance : kNobody, .rate_hz = c.rate};
}

Mat6 slope_of_weight(const ArmDynamics& arm, const Vec6& q) {
  constexpr double kStep = 1e-5;  // [rad]; sines lose 1e-11 of their slope by it
  Mat6 slope;
  for (int i = 0; i < 6; ++i) {
    const Vec6 step = kStep * Vec6::Unit(i);
    slope.col(i) = (gravity_torques(arm, q + step) - gravity_torques(arm, q - step)) / (2 * kStep);
  }
  return slope;
}

ArmAxis arm_axis(const SimArmConfig& config, const SlaveConfig& slave, const Vec3& axis_S) {
  const ArmDynamics dynamics = make_arm_dynamics(config.model);
  const ArmJacobian J = jacobian(slave.arm, config.q);
  Mat6 both;
  both << J.linear, J.angular;
  return {.M = mass_matrix(dynamics, config.q),
          .K_g = slope_of_weight(dynamics, config.q),
          .g = J.linear.transpose() * axis_S,
          .c = both.partialPivLu().solve((Vec6() << axis_S, Vec3::Zero()).finished()),
          .rate_hz = config.rate_hz,
          .servo = slave.servo};
}

// The gains are diagonal along the handle's axes, which at the start are nearly those of M.
std::optional<AxisForceLoop> force_loop(const ForceControllerConfig& config, const Vec3& axis_M) {
  if (!config.closed_loop) return {};
  AxisForceLoop out{.filter_error = config.closed_loop->filter_error};
  for (std::size_t i = 0; i < 3; ++i) {
    const double share = axis_M[static_cast<int>(i)] * axis_M[static_cast<int>(i)];
    const PidConfig& g = config.closed_loop->axes[i].gains;
    out.cutoff_hz += share * config.closed_loop->axes[i].cutoff_hz;
    out.gains.kp += share * g.kp;
    out.gains.ki += share * g.ki;
    out.gains.kd += share * g.kd;
    out.gains.derivative_cutoff_hz += share * g.derivative_cutoff_hz;
  }
  return out;
}

Duration delay(bool present, const proto::Impairment& i) {
  if (!present) return Impairment::kPlainDelay;
  const bool one_sided = i.jitter() == proto::Impairment::GAMMA;
  return milliseconds(i.delay_ms() + (one_sided ? i.jitter_ms() : 0));
}

}  // namespace

int surfaces(const Scene& scene) {
  return scene.proto.slave().sim_arm().surface_size();
}

AxisModel axis_model(const Scene& scene, int surface) {
  const proto::Scene& s = scene.proto;
  if (!s.master().has_sim_hand() || !s.slave().has_sim_arm() || surface >= surfaces(scene))
    throw std::runtime_error(scene.path +
                             " has no hand, arm and surface to be analysed; add sim_hand, sim_arm "
                             "and a surface in it");
  if (s.has_bilateral())
    throw std::runtime_error(scene.path +
                             ": only position-force is analysed; remove bilateral { ... } to see "
                             "what it would be");
  const SlaveConfig slave = slave_config(s);
  const SimArmConfig arm = arm_config(s);
  const Surface& wall = arm.surfaces.items[static_cast<std::size_t>(surface)];
  const Vec3 axis_S = -proximity(wall.shape, forward(slave.arm, arm.q).p).normal;
  const Vec3 axis_M = slave.workspace.R_SM.transpose() * axis_S;
  const MasterConfig master = master_config(s);
  AxisModel out{.Ts = slave.Ts,
                .hand = hand_axis(scene),
                .arm = arm_axis(arm, slave, axis_S),
                .wall = {.stiffness = wall.stiffness, .damping = wall.damping},
                .reflects = s.master().has_force_feedback() && slave.force_sensing.has_value(),
                .scale = slave.workspace.scale,
                .force_scale = slave.workspace.force_scale,
                .sensing_cutoff_hz = slave.force_sensing ? slave.force_sensing->cutoff_hz : 0,
                .to_slave = delay(s.link().has_to_slave(), s.link().to_slave()),
                .to_master = delay(s.link().has_to_master(), s.link().to_master()),
                .cut_off = master_loop_config(s).cut_off,
                .axis_S = axis_S,
                .axis_M = axis_M};
  if (!out.reflects) return out;
  const ForceControllerConfig& controller = master.force_feedback->controller;
  out.force = force_loop(controller, axis_M);
  out.device = axis_device(controller, master.force_sensing.has_value());
  return out;
}

double small_gain(const AxisModel& m) noexcept {
  if (!m.force) return 0;
  const double mass = m.hand.device.mass + m.hand.hand.mass;
  return (m.force->gains.kp + 2 * m.force->gains.kd / m.Ts) * m.hand.hand.mass / mass;
}

}  // namespace farhand
