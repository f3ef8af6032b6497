#include <cstdint>
#include <numbers>

#include "common/geometry.hpp"
#include "common/scene_bilateral.hpp"
#include "common/scene_rules.hpp"

namespace farhand {
namespace {

using Rules = SceneRules;
using proto::Scene;

void scene_rules(Rules& r) {
  rule<Scene>(
      r, "master", [](const Scene& s) { return !s.has_master(); },
      "is missing; one file describes both sides", "add master { ... } with a handle and a device");
  rule<Scene>(
      r, "slave",
      [](const Scene& s) { return !s.has_slave() && !s.master().has_position_control(); },
      "is missing, so the handle would move nothing",
      "add slave { ... } with a robot, workspace and joint_pid, or master.position_control to "
      "drive the handle itself");
  rule<Scene>(
      r, "slave",
      [](const Scene& s) {
        return s.has_slave() && s.master().has_position_control() && !cue_of_contact(s);
      },
      "has nothing to follow while position_control drives the handle",
      "remove the slave or the position_control, or give its danger_cue contact_newton");
  rule<Scene>(
      r, "link", [](const Scene& s) { return s.has_link() && !s.has_slave(); },
      "leads nowhere without a slave", "remove it");
}

// Of either side. Two spins a period then leave half of it to others.
void realtime_rules(Rules& r) {
  using R = proto::Realtime;
  constexpr std::uint64_t kLargest = 1023;
  rule<R>(
      r, "cpu", [](const R& t) { return t.cpu() > kLargest; }, "is more than any machine has",
      "give one of those that nproc counts, from 0");
  rule<R>(
      r, "spin_us", [](const Scene& s, const R& t) { return 4 * t.spin_us() * s.rate_hz() > 1e6; },
      "is more than a quarter of the tick period, 1e6 / rate_hz",
      "lower it, or lower the scene's rate_hz");
}

void master_rules(Rules& r) {
  using M = proto::Master;
  rule<M>(
      r, "", [](const M& m) { return m.handle_case() == M::HANDLE_NOT_SET; }, "has no handle",
      "add falcon {} or twin_delta {}");
  rule<M>(
      r, "", [](const M& m) { return m.device_case() == M::DEVICE_NOT_SET; },
      "has no device that moves the handle", "add sim_hand {}, or falcon_usb {} for a real Falcon");
  rule<M>(
      r, "falcon_usb", [](const M& m) { return m.has_falcon_usb() && !m.has_falcon(); },
      "is a Falcon, and the handle is another",
      "use falcon {} as the handle, or sim_hand {} as the device");
  rule<M>(
      r, "position_control",
      [](const M& m) { return m.has_position_control() && m.has_twin_delta(); },
      "is for the Falcon", "use falcon, or remove it");
  rule<M>(
      r, "force_feedback",
      [](const M& m) { return m.has_force_feedback() && m.has_position_control(); },
      "and position_control would both drive the motors", "keep one of the two");
  rule<M>(
      r, "force_feedback",
      [](const Scene& s, const M& m) {
        return m.has_force_feedback() && !m.has_guidance() && channels(s).contact_force &&
               !s.slave().has_force_sensing() && !s.slave().has_boundary();
      },
      "has no force to reflect", "add force_sensing {} to the slave, or remove force_feedback");
  rule<M>(
      r, "guidance", [](const M& m) { return m.has_guidance() && !m.has_force_feedback(); },
      "is felt through force_feedback, which is missing", "add force_feedback {}");
  below_half_the_rate<M>(r, "velocity_cutoff_hz");
  not_on_falcon<M>(r, {"force_sensing"});

  using F = proto::ForceFeedback;
  rule<F>(
      r, "fade_ms",
      [](const Scene& s, const F& f) { return f.hold_ms() + f.fade_ms() > s.link().lost_ms(); },
      "after hold_ms ends later than link.lost_ms, so force would outlast the peer",
      "shorten hold_ms and fade_ms, or raise link.lost_ms");
  not_on_falcon<F>(r, {"max_torque_newton_meter", "max_twist_torque_newton_meter",
                       "max_torque_rate_newton_meter_per_s"});
}

void guidance_rules(Rules& r) {
  using G = proto::Guidance;
  rule<G>(
      r, "", [](const G& g) { return g.fixture_size() == 0 && !g.has_handle_limits(); },
      "guides nothing", "add fixture { ... } or handle_limits {}");
  using F = proto::Fixture;
  rule<F>(
      r, "", [](const F& f) { return f.shape_case() == F::SHAPE_NOT_SET; }, "has no shape",
      "add plane { ... }, axis { ... } or sphere { ... }");
  rule<proto::FixturePlane>(
      r, "normal", [](const proto::FixturePlane& p) { return norm(p.normal()) < 1e-6; },
      "has no length", "give the direction to the free side, such as [1, 0, 0]");
  rule<proto::FixtureAxis>(
      r, "direction", [](const proto::FixtureAxis& a) { return norm(a.direction()) < 1e-6; },
      "has no length", "give the direction of the line, such as [1, 0, 0]");
  using B = proto::Boundary;
  not_on_falcon<B>(r, {"max_torque_newton_meter", "max_torque_rate_newton_meter_per_s"});
}

void force_control_rules(Rules& r) {
  using F = proto::ForceFeedback;
  rule<F>(
      r, "closed_loop",
      [](const Scene& s, const F& f) {
        return f.has_closed_loop() && s.master().has_twin_delta() &&
               !s.master().has_force_sensing();
      },
      "has no measured force to close on", "add force_sensing {} to the master, or remove it");
  rule<F>(
      r, "closed_loop",
      [](const Scene& s, const F& f) {
        return f.has_closed_loop() && s.master().has_falcon() && !f.has_disturbance_observer();
      },
      "has no force to close on, since a Falcon senses none",
      "add device_model {} and disturbance_observer {}, which estimate it, or remove it");
  const auto needs_model = [&r](const char* name, bool (F::*has)() const) {
    rule<F>(
        r, name, [has](const F& f) { return (f.*has)() && !f.has_device_model(); },
        "knows nothing of the handle", "add device_model {}, or remove it");
  };
  needs_model("device_feedforward", &F::has_device_feedforward);
  needs_model("contact_damping", &F::has_contact_damping);
  needs_model("disturbance_observer", &F::has_disturbance_observer);
  rule<F>(
      r, "disturbance_observer",
      [](const Scene& s, const F& f) {
        return f.has_disturbance_observer() && s.master().has_twin_delta() &&
               !s.master().has_force_sensing();
      },
      "would take the user for a disturbance", "add force_sensing {} to the master, or remove it");

  using C = proto::ClosedLoop;
  below_half_the_rate<C>(r, "cutoff_hz");
  below_half_the_rate<proto::ForceGains>(r, "cutoff_hz");
  below_half_the_rate<proto::ForceGains>(r, "derivative_cutoff_hz");
  each<C>(
      r, "axis",
      [](const C& c, int i) {
        for (int j = 0; j < i; ++j)
          if (c.axis(j).axis() == c.axis(i).axis()) return true;
        return false;
      },
      "names an axis a second time", "give each axis once");
  not_on_falcon<C>(r, {"torque", "twist"});

  using M = proto::DeviceModel;
  rule<M>(
      r, "motor_delay_ms",
      [](const Scene& s, const M& m) { return m.motor_delay_ms() * 1e-3 * s.rate_hz() > 7.5; },
      "is more than seven ticks", "lower it, or lower the scene's rate_hz");
  not_on_falcon<M>(
      r, {"rotation_inertia_kg_m2", "rotation_damping_newton_m_s", "rotation_friction_newton_m",
          "twist_inertia_kg_m2", "twist_damping_newton_m_s"});
  not_on_falcon<proto::ContactDamping>(
      r, {"rotation_damping_newton_m_s", "twist_damping_newton_m_s", "torque_newton_meter"});
  not_on_falcon<proto::DeviceFeedforward>(r, {"rotation_inertia_share"});
  not_on_falcon<proto::DisturbanceObserver>(r, {"share"});
}

void position_control_rules(Rules& r) {
  using P = proto::PositionControl;
  below_half_the_rate<P>(r, "derivative_cutoff_hz");
  // Half of where backward differences on a free mass become unstable: kd Ts = 2 m.
  rule<P>(
      r, "kd_newton_s_per_m",
      [](const Scene& s, const P& p) {
        const auto& hand = s.master().sim_hand();
        const double mass =
            hand.device_mass_kg() + (hand.has_operator_() ? hand.operator_().hand_mass_kg() : 0);
        return s.master().has_sim_hand() && p.kd_newton_s_per_m() > mass * s.rate_hz();
      },
      "times the tick period exceeds the moving mass, so the handle would vibrate",
      "give at most the moving mass times rate_hz");
  // Braking above the safe speed is a damper; half of where it becomes unstable, as above.
  rule<P>(
      r, "max_speed_m_per_s",
      [](const Scene& s, const P& p) {
        return p.max_speed_m_per_s() > 0 && s.master().has_sim_hand() &&
               p.max_force_newton() - kGravity * p.gravity_mass_kg() >
                   p.max_speed_m_per_s() * s.master().sim_hand().device_mass_kg() * s.rate_hz();
      },
      "is so low that braking to it would make the handle vibrate",
      "raise it, lower max_force_newton, or raise the scene's rate_hz");
  rule<P>(
      r, "max_force_newton",
      [](const P& p) {
        return p.max_speed_m_per_s() > 0 && p.max_force_newton() <= kGravity * p.gravity_mass_kg();
      },
      "does not exceed the weight, so nothing is left to move the grip at max_speed_m_per_s",
      "raise it, or lower gravity_mass_kg");
  rule<P>(
      r, "park", [](const P& p) { return p.has_park() && p.max_speed_m_per_s() == 0; },
      "would send the grip there with all its force", "add max_speed_m_per_s");
  rule<P>(
      r, "max_force_rate_newton_per_s",
      [](const P& p) { return p.has_max_force_rate_newton_per_s() && p.max_speed_m_per_s() == 0; },
      "acts only in safe motion", "add max_speed_m_per_s, or remove it");
  rule<P>(
      r, "danger_cue.contact_newton",
      [](const Scene& s, const P&) { return cue_of_contact(s) && !s.slave().has_force_sensing(); },
      "listens to a force that nothing senses", "add a slave with force_sensing {}, or remove it");
  each<P>(
      r, "set_point",
      [](const P& p, int i) { return i > 0 && p.set_point(i).at_s() <= p.set_point(i - 1).at_s(); },
      "comes no later than the one before it",
      "write set points in the order of at_s, each later than the last");
}

// Semi-implicit Euler on m x'' = -k x - c x' with steps of h diverges at k h^2 / m + 2 c h / m = 4;
// half of it is accepted.
bool coarse(double stiffness, double damping, double inertia, double rate) {
  return stiffness / (rate * rate) + 2 * damping / rate > 2 * inertia;
}

bool hand_steps_are_coarse(const Scene& s, const proto::SimHand& h) {
  const proto::Operator& o = h.operator_();
  const double held = h.has_operator_() ? 1 : 0;
  const bool turns = s.master().has_twin_delta();
  return coarse(held * o.stiffness_newton_per_m(),
                h.device_damping_newton_s_per_m() + held * o.damping_newton_s_per_m(),
                h.device_mass_kg() + held * o.hand_mass_kg(), h.rate_hz()) ||
         (turns && coarse(held * o.rotation_stiffness_newton_m_per_rad(),
                          h.rotation_damping_newton_m_s() + held * o.rotation_damping_newton_m_s(),
                          h.rotation_inertia_kg_m2(), h.rate_hz())) ||
         (turns && coarse(held * o.twist_stiffness_newton_m_per_rad(),
                          h.twist_damping_newton_m_s() + held * o.twist_damping_newton_m_s(),
                          h.twist_inertia_kg_m2(), h.rate_hz()));
}

bool overlaps_earlier(const proto::Operator& o, int i) {
  const auto& a = o.press(i);
  for (int j = 0; j < i; ++j) {
    const auto& b = o.press(j);
    if (a.button() == b.button() && a.at_s() < b.at_s() + b.lasting_s() &&
        b.at_s() < a.at_s() + a.lasting_s())
      return true;
  }
  return false;
}

bool never_engages(const proto::Operator& o) {
  for (const auto& press : o.press())
    if (press.button() == proto::Press::DEAD_MAN) return false;
  return o.press_size() > 0;
}

void hand_rules(Rules& r) {
  using H = proto::SimHand;
  rule<H>(
      r, "rate_hz", [](const Scene& s, const H& h) { return h.rate_hz() < s.rate_hz(); },
      "is less than one step per tick", "raise it to the scene's rate_hz or above");
  rule<H>(r, "rate_hz", hand_steps_are_coarse,
          "is too coarse for the stiffness and damping around the handle's mass",
          "raise it, or soften the hand");
  not_on_falcon<H>(
      r, {"rotation_inertia_kg_m2", "rotation_damping_newton_m_s", "rotation_friction_newton_m",
          "twist_inertia_kg_m2", "twist_damping_newton_m_s", "force_noise_newton",
          "sensor_bias_newton", "grip_mass_kg"});

  using O = proto::Operator;
  not_on_falcon<O>(r, {"rotation_stiffness_newton_m_per_rad", "rotation_damping_newton_m_s",
                       "twist_stiffness_newton_m_per_rad", "twist_damping_newton_m_s"});
  each<O>(
      r, "press", [](const O& o, int i) { return overlaps_earlier(o, i); },
      "overlaps an earlier press of the same button",
      "give the earlier one a lasting_s that ends before, or move this one");
  rule<O>(
      r, "press", [](const O& o) { return never_engages(o); },
      "scripts buttons but never the dead-man, so nothing would move",
      "add press { button: DEAD_MAN at_s: 0.5 }");
}

void motion_rules(Rules& r) {
  constexpr double kTurn = 2 * std::numbers::pi;
  using M = proto::Motion;
  rule<M>(
      r, "trace", [](const M& m) { return m.has_trace() && m.sine_size() + m.reach_size() > 0; },
      "cannot be combined with sine or reach", "keep the trace or the others");
  each<M>(
      r, "sine",
      [](const M& m, int i) {
        return kTurn * m.sine(i).frequency_hz() * norm(m.sine(i).amplitude_m()) >
               m.max_speed_m_per_s();
      },
      "is faster at its peak, 2 pi frequency times amplitude, than max_speed_m_per_s",
      "slow it down, or raise max_speed_m_per_s");
  each<M>(
      r, "sine",
      [](const M& m, int i) {
        return kTurn * m.sine(i).frequency_hz() * norm(m.sine(i).amplitude_deg()) >
               m.max_turn_rate_deg_per_s();
      },
      "turns faster at its peak than max_turn_rate_deg_per_s",
      "slow it down, or raise max_turn_rate_deg_per_s");
  // A minimum-jerk move peaks at 15/8 of its mean speed.
  each<M>(
      r, "reach",
      [](const M& m, int i) {
        return 1.875 * norm(m.reach(i).by_m()) > m.max_speed_m_per_s() * m.reach(i).lasting_s();
      },
      "is faster at its peak, 15/8 of the mean, than max_speed_m_per_s",
      "give it a longer lasting_s, or raise max_speed_m_per_s");
  each<M>(
      r, "reach",
      [](const M& m, int i) {
        return 1.875 * norm(m.reach(i).turn_deg()) >
               m.max_turn_rate_deg_per_s() * m.reach(i).lasting_s();
      },
      "turns faster at its peak than max_turn_rate_deg_per_s",
      "give it a longer lasting_s, or raise max_turn_rate_deg_per_s");

  using S = proto::Sine;
  rule<S>(
      r, "until_s", [](const S& s) { return s.until_s() <= s.from_s(); }, "is not after from_s",
      "give a later until_s, or leave it out for a sine without end");
  rule<S>(
      r, "", [](const S& s) { return s.amplitude_m_size() + s.amplitude_deg_size() == 0; },
      "moves nothing", "add amplitude_m: [x, y, z] or amplitude_deg: [x, y, twist]");
  below_half_the_rate<S>(r, "frequency_hz");
  using R = proto::Reach;
  rule<R>(
      r, "", [](const R& m) { return m.by_m_size() + m.turn_deg_size() == 0; }, "moves nothing",
      "add by_m: [x, y, z] or turn_deg: [x, y, twist]");
}

}  // namespace

void add_master_rules(SceneRules& rules) {
  scene_rules(rules);
  realtime_rules(rules);
  master_rules(rules);
  guidance_rules(rules);
  force_control_rules(rules);
  position_control_rules(rules);
  hand_rules(rules);
  motion_rules(rules);
}

}  // namespace farhand
