#include "tests/sim/plan_scene.hpp"

#include "tests/support/scene_edits.hpp"

namespace farhand {
namespace {

// The wall of the scene, and the arm behind its servo as seen there: deploy/docs/compensation.md.
void choose_smith(Scene& scene) {
  proto::SmithCompensation& s = *scene.proto.mutable_compensation()->mutable_smith();
  s.set_robot_mass_kg(4), s.set_servo_stiffness_newton_per_m(5800);
  s.set_servo_damping_newton_s_per_m(270);
  const proto::Surface& surface = scene.proto.slave().sim_arm().surface(0);
  proto::RegisteredWall& w = *s.mutable_wall();
  *w.mutable_point_in_slave_m() = surface.plane().point_m();
  for (const double n : surface.plane().normal()) w.add_normal_in_slave(-n);
  w.set_stiffness_newton_per_m(surface.stiffness_newton_per_m());
  w.set_damping_newton_s_per_m(surface.damping_newton_s_per_m());
}

// As tests/loop/answers_test.cpp; a steady force and the link must outlast two lost answers.
void leave_out_answers(Scene& scene, double keep_alive_ms) {
  proto::Link& link = *scene.proto.mutable_link();
  link.set_stale_ms(std::max(link.stale_ms(), 4 * keep_alive_ms));
  proto::ForceFeedback& f = *scene.proto.mutable_master()->mutable_force_feedback();
  f.set_hold_ms(std::max(f.hold_ms(), 2 * keep_alive_ms));
  proto::ForceDeadband& d = *link.mutable_deadband();
  d.set_keep_alive_ms(keep_alive_ms);
  d.set_floor_newton(0.25), d.set_floor_newton_meter(0.01);
}

void choose(Scene& scene, const Plan& plan) {
  if (!plan.method.empty()) choose_method(scene, plan.method);
  if (plan.one_way_ms) {
    proto::Link& link = *scene.proto.mutable_link();
    for (proto::Impairment* way : {link.mutable_to_slave(), link.mutable_to_master()})
      way->set_delay_ms(*plan.one_way_ms);
  }
  if (plan.keep_alive_ms) leave_out_answers(scene, *plan.keep_alive_ms);
  if (plan.alignment_deg)
    scene.proto.mutable_slave()->mutable_workspace()->set_alignment_deg(*plan.alignment_deg);
}

// From one orientation to another, each up to 12 deg about every axis from the middle.
void turn_away(proto::Motion& m, const Plan& plan, Random& random) {
  Vec3 last = Vec3::Zero();
  for (double t = 4; t < seconds(plan.quiet) - 2; t += 2 + 4 * random.uniform()) {
    proto::Reach& r = *m.add_reach();
    r.set_at_s(t), r.set_lasting_s(1.5);
    const Vec3 next =
        12 * Vec3(2 * random.uniform() - 1, 2 * random.uniform() - 1, 2 * random.uniform() - 1);
    for (const double by : Vec3(next - last)) r.add_turn_deg(by);
    last = next;
  }
}

}  // namespace

void choose_method(Scene& scene, const std::string& method) {
  proto::Compensation& c = *scene.proto.mutable_compensation();
  if (method == "damped") c.mutable_damped();
  if (method == "mmt") c.mutable_mmt();
  if (method == "auto") c.mutable_auto_();
  if (method == "direct") c.mutable_direct();
  if (method == "wave") c.mutable_wave();
  if (method == "smith") choose_smith(scene);
}

Scene scene_of(const Plan& plan) {
  Scene scene = shipped(plan.scene);
  choose(scene, plan);
  proto::Operator& o = hand(scene);
  o.clear_press();
  proto::Motion& m = *o.mutable_motion();
  m.Clear();
  Random random(plan.seed ^ 0x6d6f7665);
  proto::Sine& sine = *m.add_sine();
  sine.set_frequency_hz(0.3 + 0.3 * random.uniform());
  for (int i = 0; i < 3; ++i) sine.add_amplitude_m(0.015 * random.uniform());
  const bool rotates = scene.proto.master().has_twin_delta();
  if (rotates)
    for (int i = 0; i < 3; ++i) sine.add_amplitude_deg(8 * random.uniform());
  if (plan.alignment_deg) turn_away(m, plan, random);
  if (scene.proto.slave().sim_arm().surface_size() == 0) return scene;
  const Vec3 forward = 0.03 * (rotates ? Vec3(-1, 0, 0) : Vec3(0, 0, -1));
  for (double t = 3; t < seconds(plan.end); t += 6) {
    reach(m, t, 1, forward);
    reach(m, t + 3, 1, -forward);
  }
  return scene;
}

}  // namespace farhand
