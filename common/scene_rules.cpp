// How the parts of a scene must fit together, one line per rule. A rule belongs to a message type
// and is asked wherever a message of that type stands. The sentence follows the field's path and,
// for a number or text, its value.
#include <cmath>
#include <functional>
#include <initializer_list>
#include <numbers>
#include <vector>

#include "common/address.hpp"
#include "common/scene_check.hpp"

namespace farhand {
namespace {

using google::protobuf::Descriptor;
using google::protobuf::FieldDescriptor;
using google::protobuf::Message;
using google::protobuf::RepeatedField;
using proto::Scene;
using Rules = std::vector<struct Rule>;

struct Rule {
  const Descriptor* type;
  std::string field;  // the one to blame, below the message; empty: the message itself
  bool each;          // asked for every element of the field
  std::function<bool(const Scene&, const Message&, int)> broken;
  std::string what;
  std::string remedy;
};

// broken(scene, message)
template <typename M, typename F>
void rule(Rules& rules, std::string field, F broken, std::string what, std::string remedy) {
  const auto ask = [broken](const Scene& s, const Message& m, int) {
    return broken(s, static_cast<const M&>(m));
  };
  rules.push_back(
      {M::descriptor(), std::move(field), false, ask, std::move(what), std::move(remedy)});
}

// broken(scene, message, index)
template <typename M, typename F>
void each(Rules& rules, std::string field, F broken, std::string what, std::string remedy) {
  const auto ask = [broken](const Scene& s, const Message& m, int i) {
    return broken(s, static_cast<const M&>(m), i);
  };
  rules.push_back(
      {M::descriptor(), std::move(field), true, ask, std::move(what), std::move(remedy)});
}

bool given(const Message& m, const FieldDescriptor& field) {
  const auto& r = *m.GetReflection();
  return field.is_repeated() ? r.FieldSize(m, &field) > 0 : r.HasField(m, &field);
}

// A Falcon moves in three translations and its grip senses no force.
template <typename M>
void not_on_falcon(Rules& rules, std::initializer_list<const char*> fields) {
  for (const char* name : fields) {
    const FieldDescriptor* field = M::descriptor()->FindFieldByName(name);
    rule<M>(
        rules, name,
        [field](const Scene& s, const M& m) { return s.master().has_falcon() && given(m, *field); },
        "means nothing on a Falcon, which neither turns nor feels force",
        "remove it, or use the twin_delta handle");
  }
}

// Sampling cannot tell higher frequencies from lower ones. 0 means no filter.
template <typename M>
void below_half_the_rate(Rules& rules, const char* name) {
  const FieldDescriptor* field = M::descriptor()->FindFieldByName(name);
  rule<M>(
      rules, name,
      [field](const Scene& s, const M& m) {
        return 2 * m.GetReflection()->GetDouble(m, field) >= s.rate_hz();
      },
      "is not below half the tick rate", "lower it, or raise the scene's rate_hz");
}

double norm(const RepeatedField<double>& v) {
  double sum = 0;
  for (const double x : v) sum += x * x;
  return std::sqrt(sum);
}

// ---- scene, master
// -----------------------------------------------------------------------------------------------------

void scene_rules(Rules& r) {
  rule<Scene>(
      r, "master", [](const Scene&, const Scene& s) { return !s.has_master(); },
      "is missing; one file describes both sides", "add master { ... } with a handle and a device");
  rule<Scene>(
      r, "slave",
      [](const Scene&, const Scene& s) {
        return !s.has_slave() && !s.master().has_position_control();
      },
      "is missing, so the handle would move nothing",
      "add slave { ... } with a robot, workspace and joint_pid, or master.position_control to "
      "drive the handle itself");
  rule<Scene>(
      r, "slave",
      [](const Scene&, const Scene& s) {
        return s.has_slave() && s.master().has_position_control();
      },
      "has nothing to follow while position_control drives the handle",
      "remove the slave or the position_control");
  rule<Scene>(
      r, "link", [](const Scene&, const Scene& s) { return s.has_link() && !s.has_slave(); },
      "leads nowhere without a slave", "remove it");
}

void master_rules(Rules& r) {
  using M = proto::Master;
  rule<M>(
      r, "", [](const Scene&, const M& m) { return m.handle_case() == M::HANDLE_NOT_SET; },
      "has no handle", "add falcon {} or twin_delta {}");
  rule<M>(
      r, "", [](const Scene&, const M& m) { return m.device_case() == M::DEVICE_NOT_SET; },
      "has no device that moves the handle", "add sim_hand {}");
  rule<M>(
      r, "position_control",
      [](const Scene&, const M& m) { return m.has_position_control() && m.has_twin_delta(); },
      "is for the Falcon", "use falcon, or remove it");
  rule<M>(
      r, "force_feedback",
      [](const Scene&, const M& m) { return m.has_force_feedback() && m.has_position_control(); },
      "and position_control would both drive the motors", "keep one of the two");
  rule<M>(
      r, "force_feedback",
      [](const Scene& s, const M& m) {
        return m.has_force_feedback() && !s.slave().has_force_sensing();
      },
      "has no force to reflect", "add force_sensing {} to the slave, or remove force_feedback");
  below_half_the_rate<M>(r, "velocity_cutoff_hz");

  using F = proto::ForceFeedback;
  rule<F>(
      r, "fade_ms",
      [](const Scene& s, const F& f) { return f.hold_ms() + f.fade_ms() > s.link().lost_ms(); },
      "after hold_ms ends later than link.lost_ms, so force would outlast the peer",
      "shorten hold_ms and fade_ms, or raise link.lost_ms");
  not_on_falcon<F>(r, {"max_torque_newton_meter", "max_twist_torque_newton_meter",
                       "max_torque_rate_newton_meter_per_s"});
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
  each<P>(
      r, "set_point",
      [](const Scene&, const P& p, int i) {
        return i > 0 && p.set_point(i).at_s() <= p.set_point(i - 1).at_s();
      },
      "comes no later than the one before it",
      "write set points in the order of at_s, each later than the last");
}

// ---- simulated hand
// ----------------------------------------------------------------------------------------------------

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
          "torque_noise_newton_meter"});

  using O = proto::Operator;
  not_on_falcon<O>(r, {"rotation_stiffness_newton_m_per_rad", "rotation_damping_newton_m_s",
                       "twist_stiffness_newton_m_per_rad", "twist_damping_newton_m_s"});
  each<O>(
      r, "press", [](const Scene&, const O& o, int i) { return overlaps_earlier(o, i); },
      "overlaps an earlier press of the same button",
      "give the earlier one a lasting_s that ends before, or move this one");
  rule<O>(
      r, "press", [](const Scene&, const O& o) { return never_engages(o); },
      "scripts buttons but never the dead-man, so nothing would move",
      "add press { button: DEAD_MAN at_s: 0.5 }");
}

void motion_rules(Rules& r) {
  constexpr double kTurn = 2 * std::numbers::pi;
  using M = proto::Motion;
  rule<M>(
      r, "trace",
      [](const Scene&, const M& m) { return m.has_trace() && m.sine_size() + m.reach_size() > 0; },
      "cannot be combined with sine or reach", "keep the trace or the others");
  not_on_falcon<M>(r, {"max_turn_rate_deg_per_s"});
  not_on_falcon<proto::Trace>(r, {"rotation_scale", "max_tilt_deg"});
  each<M>(
      r, "sine",
      [](const Scene&, const M& m, int i) {
        return kTurn * m.sine(i).frequency_hz() * norm(m.sine(i).amplitude_m()) >
               m.max_speed_m_per_s();
      },
      "is faster at its peak, 2 pi frequency times amplitude, than max_speed_m_per_s",
      "slow it down, or raise max_speed_m_per_s");
  each<M>(
      r, "sine",
      [](const Scene&, const M& m, int i) {
        return kTurn * m.sine(i).frequency_hz() * norm(m.sine(i).amplitude_deg()) >
               m.max_turn_rate_deg_per_s();
      },
      "turns faster at its peak than max_turn_rate_deg_per_s",
      "slow it down, or raise max_turn_rate_deg_per_s");
  // A minimum-jerk move peaks at 15/8 of its mean speed.
  each<M>(
      r, "reach",
      [](const Scene&, const M& m, int i) {
        return 1.875 * norm(m.reach(i).by_m()) > m.max_speed_m_per_s() * m.reach(i).lasting_s();
      },
      "is faster at its peak, 15/8 of the mean, than max_speed_m_per_s",
      "give it a longer lasting_s, or raise max_speed_m_per_s");
  each<M>(
      r, "reach",
      [](const Scene&, const M& m, int i) {
        return 1.875 * norm(m.reach(i).turn_deg()) >
               m.max_turn_rate_deg_per_s() * m.reach(i).lasting_s();
      },
      "turns faster at its peak than max_turn_rate_deg_per_s",
      "give it a longer lasting_s, or raise max_turn_rate_deg_per_s");

  using S = proto::Sine;
  rule<S>(
      r, "until_s", [](const Scene&, const S& s) { return s.until_s() <= s.from_s(); },
      "is not after from_s", "give a later until_s, or leave it out for a sine without end");
  rule<S>(
      r, "",
      [](const Scene&, const S& s) { return s.amplitude_m_size() + s.amplitude_deg_size() == 0; },
      "moves nothing", "add amplitude_m: [x, y, z] or amplitude_deg: [x, y, twist]");
  not_on_falcon<S>(r, {"amplitude_deg"});
  below_half_the_rate<S>(r, "frequency_hz");
  using R = proto::Reach;
  rule<R>(
      r, "", [](const Scene&, const R& m) { return m.by_m_size() + m.turn_deg_size() == 0; },
      "moves nothing", "add by_m: [x, y, z] or turn_deg: [x, y, twist]");
  not_on_falcon<R>(r, {"turn_deg"});
}

// ---- slave
// -------------------------------------------------------------------------------------------------------------

void slave_rules(Rules& r) {
  using S = proto::Slave;
  rule<S>(
      r, "", [](const Scene&, const S& s) { return s.robot_case() == S::ROBOT_NOT_SET; },
      "has no robot", "add sim_arm {}");
  rule<S>(
      r, "workspace", [](const Scene&, const S& s) { return !s.has_workspace(); },
      "is missing, so no handle pose becomes a tool pose", "add workspace {}");
  rule<S>(
      r, "joint_pid", [](const Scene&, const S& s) { return !s.has_joint_pid(); },
      "is missing, so nothing drives the joints", "add joint_pid {}");
  rule<S>(
      r, "force_sensing",
      [](const Scene& s, const S& m) {
        return m.has_force_sensing() && !s.master().has_force_feedback();
      },
      "sends a force nobody reflects",
      "add force_feedback {} to the master, or remove force_sensing");
  rule<S>(
      r, "force_sensing",
      [](const Scene&, const S& s) {
        return s.has_force_sensing() && s.has_sim_arm() && !s.sim_arm().has_force_sensor();
      },
      "has no sensor to read", "add force_sensor {} to sim_arm");
  rule<S>(
      r, "sim_arm.force_sensor",
      [](const Scene&, const S& s) {
        return s.sim_arm().has_force_sensor() && !s.has_force_sensing();
      },
      "is read by nobody", "add force_sensing {} to the slave, or remove the sensor");
  rule<S>(
      r, "joint_pid.friction_compensation",
      [](const Scene&, const S& s) {
        return s.joint_pid().has_friction_compensation() && s.has_sim_arm() &&
               !s.sim_arm().friction();
      },
      "would push joints that have no friction", "remove it, or give sim_arm friction: true");
  using J = proto::JointPid;
  below_half_the_rate<J>(r, "derivative_cutoff_hz");
  below_half_the_rate<proto::VelocityFeedforward>(r, "cutoff_hz");
  // kd Ts = 2 z w J Ts; half of where backward differences on J become unstable.
  rule<J>(
      r, "bandwidth_hz",
      [](const Scene& s, const J& j) {
        return 4 * std::numbers::pi * j.damping_ratio() * j.bandwidth_hz() > s.rate_hz();
      },
      "is too fast for the tick rate: 4 pi damping_ratio bandwidth_hz exceeds it, so the joints "
      "would vibrate",
      "lower it, or raise the scene's rate_hz");
  below_half_the_rate<proto::ForceSensing>(r, "cutoff_hz");
}

template <typename M>
void tool_rule(Rules& r) {
  rule<M>(
      r, "tool_com_m",
      [](const Scene&, const M& m) { return m.tool_com_m_size() > 0 && m.tool_mass_kg() == 0; },
      "has no effect without a mass", "add tool_mass_kg, or remove it");
}

void arm_rules(Rules& r) {
  using A = proto::SimArm;
  rule<A>(
      r, "rate_hz", [](const Scene& s, const A& a) { return a.rate_hz() < s.rate_hz(); },
      "is less than one step per tick", "raise it to the scene's rate_hz or above");
  tool_rule<proto::ForceSensing>(r);
  tool_rule<proto::SimForceSensor>(r);
  using S = proto::Surface;
  rule<S>(
      r, "", [](const Scene&, const S& s) { return s.shape_case() == S::SHAPE_NOT_SET; },
      "has no shape", "add plane { ... }, sphere { ... } or box { ... }");
  // Runge-Kutta of fourth order is stable to about 2.8 on either axis; the tool end of the arm
  // weighs 1 kg at its lightest.
  rule<S>(
      r, "stiffness_newton_per_m",
      [](const Scene& s, const S& m) {
        const double rate = s.slave().sim_arm().rate_hz();
        return m.stiffness_newton_per_m() / (rate * rate) + m.damping_newton_s_per_m() / rate > 1;
      },
      "together with the damping is too hard for the arm's integration steps",
      "soften the surface, or raise sim_arm.rate_hz");
  rule<proto::Plane>(
      r, "normal", [](const Scene&, const proto::Plane& p) { return norm(p.normal()) < 1e-6; },
      "has no length", "give the direction out of the solid, such as [0, -1, 0]");
}

// ---- link
// --------------------------------------------------------------------------------------------------------------

using Link = proto::Link;
using Text = const std::string& (Link::*)() const;

// Several of the rules below are about one address; what another rule refuses passes here.
template <typename F>
auto parsed(Text text, F broken) {
  return [text, broken](const Scene&, const Link& l) {
    const auto a = parse_address((l.*text)());
    return a && broken(l, *a);
  };
}

template <typename F>
auto both_parsed(F broken) {
  return [broken](const Scene&, const Link& l) {
    const auto slave = parse_address(l.slave_address());
    const auto master = parse_address(l.master_address());
    return slave && master && broken(*slave, *master);
  };
}

void address_rules(Rules& r) {
  for (const auto& [name, text] : {std::pair{"slave_address", Text(&Link::slave_address)},
                                   {"master_address", Text(&Link::master_address)}}) {
    rule<Link>(
        r, name, [text = text](const Scene&, const Link& l) { return !parse_address((l.*text)()); },
        "is no address",
        "write host:port with a numeric IPv4 address, an IPv6 address in brackets or localhost, "
        "and a port from 0 to 65535");
    rule<Link>(
        r, name,
        parsed(text, [](const Link& l, const Address& a) { return !a.loopback && !l.insecure(); }),
        "is beyond this machine, and plain datagrams are unauthenticated and unencrypted: whoever "
        "reaches the port can move the robot",
        "stay on 127.0.0.1, or add insecure: true to the link on a network you trust");
  }
  rule<Link>(
      r, "slave_address",
      parsed(&Link::slave_address, [](const Link&, const Address& a) { return a.port == 0; }),
      "has port 0, so the master would not know where to send", "give a port from 1 to 65535");
  rule<Link>(r, "master_address",
             both_parsed([](const Address& s, const Address& m) { return s.ipv6 != m.ipv6; }),
             "and slave_address are not both IPv4 or both IPv6", "give both in one family");
  rule<Link>(r, "master_address", both_parsed([](const Address& s, const Address& m) {
               return s.loopback != m.loopback;
             }),
             "and slave_address are not on one network: only one of them is this machine alone",
             "give both a loopback address, or neither (0.0.0.0:0 takes any)");
  rule<Link>(r, "master_address", both_parsed([](const Address& s, const Address& m) {
               return s.host == m.host && s.port == m.port;
             }),
             "is the slave's address too", "give another port, or 0 for any free one");
}

void link_rules(Rules& r) {
  rule<Link>(
      r, "cut_off_us",
      [](const Scene& s, const Link& l) { return l.cut_off_us() * s.rate_hz() >= 1e6; },
      "is not less than the tick period, 1e6 / rate_hz", "lower it, or lower the scene's rate_hz");
  rule<Link>(
      r, "stale_ms",
      [](const Scene& s, const Link& l) { return l.stale_ms() * s.rate_hz() < 2000; },
      "is less than two tick periods, so ordinary jitter would stop the motion",
      "raise it, or raise the scene's rate_hz");
  rule<Link>(
      r, "stale_ms", [](const Scene&, const Link& l) { return l.stale_ms() >= l.lost_ms(); },
      "is not less than lost_ms",
      "motion must hold before the peer counts as gone: lower it, or raise lost_ms");
  using I = proto::Impairment;
  rule<I>(
      r, "delay_ms", [](const Scene& s, const I& i) { return i.delay_ms() >= s.link().stale_ms(); },
      "is not less than link.stale_ms, so every message would be too old on arrival",
      "raise link.stale_ms, or lower it");
  rule<I>(
      r, "jitter_ms",
      [](const Scene&, const I& i) {
        return i.jitter() != I::GAMMA && i.jitter_ms() > i.delay_ms();
      },
      "around the delay exceeds it, and nothing arrives before it was sent",
      "lower it, raise delay_ms, or use jitter: GAMMA, which only adds to the delay");
  rule<I>(
      r, "burst_leave_ratio",
      [](const Scene&, const I& i) {
        return i.burst_enter_ratio() > 0 && i.burst_leave_ratio() == 0;
      },
      "means that the first burst of losses never ends", "give more than 0");
}

// ---- asking
// ------------------------------------------------------------------------------------------------------------

// The value that the sentence is about, where it can be said in a word.
std::string subject(const Message& m, const std::string& name) {
  const FieldDescriptor* field = m.GetDescriptor()->FindFieldByName(name);
  if (field == nullptr || field->is_repeated()) return "";
  if (field->cpp_type() == FieldDescriptor::CPPTYPE_DOUBLE)
    return quantity(*field, m.GetReflection()->GetDouble(m, field)) + " ";
  if (field->cpp_type() == FieldDescriptor::CPPTYPE_STRING)
    return "'" + shortened(m.GetReflection()->GetString(m, field)) + "' ";
  return "";
}

std::optional<SceneFault> ask(const Rule& rule, const Scene& scene, const Message& m,
                              const std::string& path) {
  const std::string where = rule.field.empty() ? path : child(path, rule.field);
  const int count =
      rule.each ? m.GetReflection()->FieldSize(m, m.GetDescriptor()->FindFieldByName(rule.field))
                : 1;
  for (int i = 0; i < count; ++i)
    if (rule.broken(scene, m, i))
      return SceneFault{rule.each ? element(where, i) : where, subject(m, rule.field) + rule.what,
                        rule.remedy};
  return {};
}

std::optional<SceneFault> ask_all(const Rules& rules, const Scene& scene, const Message& m,
                                  const std::string& path) {
  for (const Rule& rule : rules)
    if (rule.type == m.GetDescriptor())
      if (auto fault = ask(rule, scene, m, path)) return fault;
  std::vector<const FieldDescriptor*> fields;
  const auto& r = *m.GetReflection();
  r.ListFields(m, &fields);
  for (const FieldDescriptor* field : fields) {
    if (field->cpp_type() != FieldDescriptor::CPPTYPE_MESSAGE) continue;
    const std::string here = child(path, field->name());
    const int count = field->is_repeated() ? r.FieldSize(m, field) : 1;
    for (int i = 0; i < count; ++i) {
      const bool list = field->is_repeated();
      const Message& inner = list ? r.GetRepeatedMessage(m, field, i) : r.GetMessage(m, field);
      if (auto fault = ask_all(rules, scene, inner, list ? element(here, i) : here)) return fault;
    }
  }
  return {};
}

}  // namespace

std::optional<SceneFault> check_rules(const Scene& scene) {
  Rules rules;
  for (const auto add : {scene_rules, master_rules, position_control_rules, hand_rules,
                         motion_rules, slave_rules, arm_rules, address_rules, link_rules})
    add(rules);
  if (auto fault = ask_all(rules, scene, scene, "")) return fault;
  // A link left out is a link of defaults, which must suit the tick rate too.
  return scene.has_slave() && !scene.has_link() ? ask_all(rules, scene, scene.link(), "link")
                                                : std::nullopt;
}

}  // namespace farhand
