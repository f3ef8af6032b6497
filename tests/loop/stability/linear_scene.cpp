#include "slave/build.hpp"
#include "tests/loop/stability/simulated.hpp"

namespace farhand {
namespace {

constexpr double kOverlap = 0.1;  // [m] of each half of the wall beyond the tool
constexpr double kNudge = 1e-3;   // [N]
constexpr double kTouch = 1e-3;   // [N] that count as contact, the least there is

void set(google::protobuf::RepeatedField<double>* field, const Vec3& v) {
  field->Assign(v.data(), v.data() + 3);
}

void add_half(proto::SimArm& arm, const WallAxis& wall, const Vec3& tool, const Vec3& normal) {
  proto::Surface& half = *arm.add_surface();
  set(half.mutable_plane()->mutable_point_m(), tool + kOverlap * normal);
  set(half.mutable_plane()->mutable_normal(), normal);
  half.set_stiffness_newton_per_m(wall.stiffness / 2);
  half.set_damping_newton_s_per_m(wall.damping / 2);
}

void idealise(proto::SimHand& hand) {
  hand.set_device_friction_newton(0);
  hand.set_device_weight_newton(0);
  hand.set_rotation_friction_newton_m(0);
  hand.set_encoder_step_rad(0);
  hand.set_force_noise_newton(0);
  hand.clear_sensor_bias_newton();
  hand.clear_grip_mass_kg();
  hand.clear_push();
  // Somebody must press the dead-man; where the scene has nobody, a hand without mass or spring.
  if (!hand.has_operator_()) {
    proto::Operator& nobody = *hand.mutable_operator_();
    nobody.set_hand_mass_kg(0);
    nobody.set_stiffness_newton_per_m(0);
    nobody.set_damping_newton_s_per_m(0);
    nobody.set_rotation_stiffness_newton_m_per_rad(0);
    nobody.set_rotation_damping_newton_m_s(0);
    nobody.set_twist_stiffness_newton_m_per_rad(0);
    nobody.set_twist_damping_newton_m_s(0);
  }
  hand.mutable_operator_()->clear_motion();
}

// As wide as their fields allow: at half the tick rate even a small force changes fast.
void open_limits(proto::Master& master) {
  if (master.has_falcon()) master.mutable_falcon()->set_max_motor_torque_newton_meter(5);
  if (master.has_twin_delta()) master.mutable_twin_delta()->set_max_motor_torque_newton_meter(20);
  master.mutable_force_feedback()->set_max_force_newton(100);
  master.mutable_force_feedback()->set_max_force_rate_newton_per_s(1e5);
}

void idealise(proto::Master& master) {
  idealise(*master.mutable_sim_hand());
  if (master.has_force_sensing()) master.mutable_force_sensing()->Clear();
  if (!master.has_force_feedback()) return;
  open_limits(master);
  proto::ForceFeedback& feedback = *master.mutable_force_feedback();
  if (!feedback.has_device_model()) return;
  feedback.mutable_device_model()->set_friction_newton(0);
  feedback.mutable_device_model()->set_rotation_friction_newton_m(0);
  feedback.mutable_device_model()->set_weight_newton(0);
}

// A constant force along the wall, as by a sensor that was weighed wrongly, small but always more
// than what counts as contact: so contact damping acts all the time, whatever the axis does.
void keep_touching(proto::Scene& scene, const AxisModel& m, const Mat3& R_SE) {
  if (!scene.master().force_feedback().has_contact_damping() || !m.reflects) return;
  proto::ContactDamping& damping =
      *scene.mutable_master()->mutable_force_feedback()->mutable_contact_damping();
  damping.set_force_newton(kTouch);
  const Vec3 along_S = m.axis_S.unitOrthogonal();
  const double force = 2 * kTouch / std::max(m.force_scale, 0.01);
  set(scene.mutable_slave()->mutable_force_sensing()->mutable_bias_newton(),
      -force * (R_SE.transpose() * along_S));
}

void idealise(proto::Slave& slave) {
  proto::SimArm& arm = *slave.mutable_sim_arm();
  arm.set_friction(false);
  arm.set_encoder_step_rad(0);
  if (arm.has_force_sensor()) {
    arm.mutable_force_sensor()->Clear();
    arm.mutable_force_sensor()->set_force_noise_newton(0);
    arm.mutable_force_sensor()->set_torque_noise_newton_meter(0);
  }
  slave.mutable_joint_pid()->clear_friction_compensation();
  if (!slave.has_force_sensing()) return;
  const double cutoff = slave.force_sensing().cutoff_hz();
  slave.mutable_force_sensing()->Clear();
  slave.mutable_force_sensing()->set_cutoff_hz(cutoff);
}

void set_network(proto::Link& link, const AxisModel& m) {
  const double to_slave = seconds(m.to_slave) * 1e3, to_master = seconds(m.to_master) * 1e3;
  link.mutable_to_slave()->Clear();
  link.mutable_to_slave()->set_delay_ms(to_slave);
  link.mutable_to_master()->Clear();
  link.mutable_to_master()->set_delay_ms(to_master);
}

void push(proto::SimHand& hand, double at, double lasting, const Vec3& force) {
  proto::Push& push = *hand.add_push();
  push.set_at_s(at);
  push.set_lasting_s(lasting);
  set(push.mutable_force_newton(), force);
}

// The dead-man once both sides know each other, then the nudge, once contact damping is all there.
void script(proto::Master& master, const AxisModel& m) {
  proto::SimHand& hand = *master.mutable_sim_hand();
  const proto::ForceFeedback& feedback = master.force_feedback();
  const double fade =
      feedback.has_contact_damping() ? feedback.contact_damping().fade_ms() / 1e3 : 0;
  const double engage = 0.3 + 5 * seconds(m.to_slave + m.to_master);
  proto::Operator& user = *hand.mutable_operator_();
  user.clear_press();
  proto::Press& press = *user.add_press();
  press.set_button(proto::Press::DEAD_MAN);
  press.set_at_s(engage);
  push(hand, engage + 0.3 + fade + 2 * seconds(m.to_slave + m.to_master), 0.004, kNudge * m.axis_M);
}

Pose tool_at_start(const proto::Scene& scene) {
  return std::visit([](const auto& r) { return r.truth().X_SE; }, make_robot(scene, 1));
}

}  // namespace

Scene linear_scene(const Scene& scene, int surface) {
  const AxisModel m = axis_model(scene, surface);
  const Pose tool = tool_at_start(scene.proto);
  Scene out = scene;
  out.proto.mutable_slave()->mutable_sim_arm()->clear_surface();
  for (const double side : {-1.0, 1.0})
    add_half(*out.proto.mutable_slave()->mutable_sim_arm(), m.wall, tool.p, side * m.axis_S);
  idealise(*out.proto.mutable_master());
  idealise(*out.proto.mutable_slave());
  set_network(*out.proto.mutable_link(), m);
  keep_touching(out.proto, m, tool.R);
  script(*out.proto.mutable_master(), m);
  return out;
}

Scene pressing_scene(const Scene& scene, int surface, double knock) {
  constexpr double kFree = 0.002, kFarthest = 0.05;  // [m]
  constexpr double kKnockTime = 0.05;                // [s]
  const AxisModel m = axis_model(scene, surface);
  Scene out = scene;
  proto::SimArm& arm = *out.proto.mutable_slave()->mutable_sim_arm();
  proto::Surface wall = arm.surface(surface);
  set(wall.mutable_plane()->mutable_point_m(),
      tool_at_start(scene.proto).p + (kFree + arm.tip_radius_m()) * m.axis_S);
  set(wall.mutable_plane()->mutable_normal(), -m.axis_S);
  arm.clear_surface();
  *arm.add_surface() = wall;
  proto::SimHand& hand = *out.proto.mutable_master()->mutable_sim_hand();
  hand.clear_push();
  if (knock > 0) push(hand, kPressed + 1, kKnockTime, knock * m.axis_M);
  proto::Operator& user = *hand.mutable_operator_();
  user.clear_press();
  user.clear_motion();
  const double wall_gives = (kFree + kPress / m.wall.stiffness) / m.scale;
  const double hand_gives = m.force_scale * kPress / std::max(m.hand.hand.stiffness, 1.0);
  proto::Reach& reach = *user.mutable_motion()->add_reach();
  reach.set_at_s(kPressed - 1);
  reach.set_lasting_s(1);
  set(reach.mutable_by_m(), std::min(wall_gives + hand_gives, kFarthest) * m.axis_M);
  return out;
}

}  // namespace farhand
