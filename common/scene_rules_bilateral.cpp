#include "common/scene_rules.hpp"

namespace farhand {
namespace {

using proto::Scene;

// The user's force crosses the network: the handle must sense it, and the robot what answers it.
template <typename M>
void needs_both_forces(SceneRules& rules) {
  rule<M>(
      rules, "", [](const Scene& s, const M&) { return s.master().has_falcon(); },
      "sends the user's force, which a Falcon does not sense",
      "use position_position, or the twin_delta handle");
  rule<M>(
      rules, "", [](const Scene& s, const M&) { return !s.master().has_force_sensing(); },
      "sends the user's force, which nothing senses", "add force_sensing {} to the master");
  rule<M>(
      rules, "", [](const Scene& s, const M&) { return !s.slave().has_force_sensing(); },
      "sets the user's force against the contact's, which nothing senses",
      "add force_sensing {} to the slave");
  rule<M>(
      rules, "", [](const Scene& s, const M&) { return s.slave().workspace().force_scale() == 0; },
      "divides the user's force by workspace.force_scale, which is 0", "give another force_scale");
}

}  // namespace

void add_compensation_rules(SceneRules& r) {
  using C = proto::Compensation;
  using D = proto::DampedCompensation;
  rule<C>(
      r, "", [](const C& c) { return c.method_case() == C::METHOD_NOT_SET; }, "names no method",
      "add auto {}, damped {}, direct {}, mmt {}, smith {} or wave {}, or remove it");
  rule<C>(
      r, "", [](const Scene& s, const C&) { return !s.has_slave(); },
      "makes up for a network to nowhere without a slave", "remove it");
  rule<C>(
      r, "", [](const Scene& s, const C&) { return !s.master().has_force_feedback(); },
      "gives a force that nobody feels", "add force_feedback {} to the master, or remove it");
  rule<C>(
      r, "",
      [](const Scene& s, const C&) { return s.has_slave() && !s.slave().has_force_sensing(); },
      "goes by what the robot touches, which nothing senses", "add force_sensing {} to the slave");
  rule<C>(
      r, "",
      [](const Scene& s, const C&) {
        return s.has_slave() && s.slave().workspace().force_scale() == 0;
      },
      "goes by forces, and workspace.force_scale is 0", "give another force_scale");
  rule<C>(
      r, "", [](const Scene& s, const C& c) { return !c.has_damped() && s.slave().has_boundary(); },
      "lets the hand feel the wall that is touched, not the robot's boundary",
      "remove the slave's boundary, or use damped {}");
  rule<C>(
      r, "",
      [](const Scene& s, const C& c) {
        return (c.has_wave() || c.has_smith()) && s.rate_hz() > 1000;
      },
      "keeps what is under way for so many ticks, too short above 1000 Hz",
      "lower rate_hz to 1000, or use another method");
  rule<proto::WaveCompensation>(
      r, "virtual_mass_kg",
      [](const Scene& s, const proto::WaveCompensation& w) {
        const double b = w.impedance_newton_s_per_m();
        const double spring = w.servo_stiffness_newton_per_m() / s.rate_hz();  // over a tick
        return b * (spring + b) / (2 * b + spring) > w.virtual_mass_kg() * s.rate_hz();
      },
      "is too light for the impedance at this rate_hz", "raise it, or lower the impedance");
  rule<proto::SmithCompensation>(
      r, "robot_mass_kg",
      [](const Scene& s, const proto::SmithCompensation& m) {
        const double rate = 4 * s.rate_hz();  // the model's own steps
        const auto& wall = m.wall();
        const double k = m.servo_stiffness_newton_per_m() + wall.stiffness_newton_per_m();
        const double d = m.servo_damping_newton_s_per_m() + wall.damping_newton_s_per_m();
        return 2 * d / rate + k / (rate * rate) > 2 * m.robot_mass_kg();
      },
      "is too light for the model's stiffness and damping", "raise it, or soften the model");
  rule<proto::RegisteredWall>(
      r, "normal_in_slave",
      [](const proto::RegisteredWall& w) { return norm(w.normal_in_slave()) < 1e-6; },
      "has no length", "give the direction into the wall, such as [0, 1, 0]");
  not_on_falcon<D>(r, {"rotation_stiffness_newton_m_per_rad", "max_rotation_damping_newton_m_s",
                       "twist_stiffness_newton_m_per_rad", "max_twist_damping_newton_m_s",
                       "virtual_inertia_kg_m2"});
}

// The answers of a slave may be left out where the contact force is all of them that is felt.
void add_deadband_rules(SceneRules& r) {
  using D = proto::ForceDeadband;
  rule<D>(
      r, "",
      [](const Scene& s, const D&) {
        return s.has_bilateral() || (s.has_compensation() && !s.compensation().has_direct());
      },
      "leaves out answers whose pose, wall or wave is felt, not only their force",
      "remove it, or use position-force without compensation or with direct {}");
  rule<D>(
      r, "",
      [](const Scene& s, const D&) { return s.has_slave() && !s.slave().has_force_sensing(); },
      "tells by a force that nothing senses", "add force_sensing {} to the slave, or remove it");
  rule<D>(
      r, "", [](const Scene& s, const D&) { return s.link().has_cut_off_us(); },
      "leaves out answers, so link.cut_off_us would be waited for in vain",
      "remove one of the two");
  rule<D>(
      r, "keep_alive_ms",
      [](const Scene& s, const D& d) { return 2 * d.keep_alive_ms() > s.link().stale_ms(); },
      "is more than half of link.stale_ms, so one lost answer would hold all motion",
      "lower it, or raise stale_ms");
  rule<D>(
      r, "keep_alive_ms",
      [](const Scene& s, const D& d) {
        return s.master().has_force_feedback() &&
               2 * d.keep_alive_ms() > s.master().force_feedback().hold_ms();
      },
      "is more than half of force_feedback.hold_ms, so one lost answer would let a steady force "
      "fade",
      "lower it, or raise hold_ms");
}

void add_bilateral_rules(SceneRules& r) {
  using B = proto::Bilateral;
  rule<B>(
      r, "", [](const B& b) { return b.architecture_case() == B::ARCHITECTURE_NOT_SET; },
      "names no architecture",
      "add position_position {}, force_position {} or force_force {}, or remove it for "
      "position-force");
  rule<B>(
      r, "", [](const Scene& s, const B&) { return !s.has_slave(); },
      "has channels to nowhere without a slave", "remove it");
  rule<B>(
      r, "", [](const Scene& s, const B&) { return !s.master().has_force_feedback(); },
      "has channels back that nobody feels", "add force_feedback {} to the master, or remove it");
  rule<B>(
      r, "", [](const Scene& s, const B&) { return s.has_compensation(); },
      "has channels of its own, and so has the compensation",
      "remove one of the two: compensation {} goes with position-force");
  needs_both_forces<proto::ForcePosition>(r);
  needs_both_forces<proto::ForceForce>(r);
  not_on_falcon<proto::RobotCoupling>(
      r, {"rotation_stiffness_newton_m_per_rad", "rotation_damping_newton_m_s",
          "twist_stiffness_newton_m_per_rad", "twist_damping_newton_m_s"});
}

}  // namespace farhand
