#include <numbers>

#include "common/address.hpp"
#include "common/scene_credentials.hpp"
#include "common/scene_rules.hpp"

namespace farhand {
namespace {

using Rules = SceneRules;
using proto::Scene;

void slave_rules(Rules& r) {
  using S = proto::Slave;
  rule<S>(
      r, "", [](const S& s) { return s.robot_case() == S::ROBOT_NOT_SET; }, "has no robot",
      "add sim_arm {}");
  rule<S>(
      r, "workspace", [](const S& s) { return !s.has_workspace(); },
      "is missing, so no handle pose becomes a tool pose", "add workspace {}");
  using W = proto::Workspace;
  rule<W>(
      r, "alignment_deg", [](const W& w) { return w.has_alignment_deg() && w.rotation_lock(); },
      "waits for a handle that is turned as the tool is, and rotation_lock lets the tool turn with "
      "none",
      "remove one of the two");
  rule<S>(
      r, "joint_pid", [](const S& s) { return !s.has_joint_pid(); },
      "is missing, so nothing drives the joints", "add joint_pid {}");
  rule<S>(
      r, "force_sensing",
      [](const Scene& s, const S& m) {
        return m.has_force_sensing() && !s.master().has_force_feedback() && !cue_of_contact(s);
      },
      "sends a force nobody reflects",
      "add force_feedback {} to the master, or remove force_sensing");
  rule<S>(
      r, "force_sensing",
      [](const S& s) {
        return s.has_force_sensing() && s.has_sim_arm() && !s.sim_arm().has_force_sensor();
      },
      "has no sensor to read", "add force_sensor {} to sim_arm");
  rule<S>(
      r, "sim_arm.force_sensor",
      [](const S& s) { return s.sim_arm().has_force_sensor() && !s.has_force_sensing(); },
      "is read by nobody", "add force_sensing {} to the slave, or remove the sensor");
  rule<S>(
      r, "joint_pid.friction_compensation",
      [](const S& s) {
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
      r, "tool_com_m", [](const M& m) { return m.tool_com_m_size() > 0 && m.tool_mass_kg() == 0; },
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
      r, "", [](const S& s) { return s.shape_case() == S::SHAPE_NOT_SET; }, "has no shape",
      "add plane { ... }, sphere { ... } or box { ... }");
  // Fourth-order Runge-Kutta holds k h^2 / m to about 7 and c h / m to 2.7; the tool end of the arm
  // is as light as half a kilogram across the wrist.
  rule<S>(
      r, "stiffness_newton_per_m",
      [](const Scene& s, const S& m) {
        const double rate = s.slave().sim_arm().rate_hz();
        return m.stiffness_newton_per_m() / (rate * rate) + m.damping_newton_s_per_m() / rate > 1;
      },
      "together with the damping is too hard for the arm's integration steps",
      "soften the surface, or raise sim_arm.rate_hz");
  rule<proto::Plane>(
      r, "normal", [](const proto::Plane& p) { return norm(p.normal()) < 1e-6; }, "has no length",
      "give the direction out of the solid, such as [0, -1, 0]");
}

using Link = proto::Link;
using Text = const std::string& (Link::*)() const;

// Several of the rules below are about one address; what another rule refuses passes here.
template <typename F>
auto parsed(Text text, F broken) {
  return [text, broken](const Link& l) {
    const auto a = parse_address((l.*text)());
    return a && broken(l, *a);
  };
}

template <typename F>
auto both_parsed(F broken) {
  return [broken](const Link& l) {
    const auto slave = parse_address(l.slave_address());
    const auto master = parse_address(l.master_address());
    return slave && master && broken(*slave, *master);
  };
}

void address_rules(Rules& r) {
  for (const auto& [name, text] : {std::pair{"slave_address", Text(&Link::slave_address)},
                                   {"master_address", Text(&Link::master_address)},
                                   {"observer_address", Text(&Link::observer_address)}}) {
    const bool optional = text == Text(&Link::observer_address);
    rule<Link>(
        r, name,
        [text = text, optional](const Link& l) {
          return (!optional || l.has_observer_address()) && !parse_address((l.*text)());
        },
        "is no address",
        "write host:port with a numeric IPv4 address, an IPv6 address in brackets or localhost, "
        "and a port from 0 to 65535");
    rule<Link>(
        r, name,
        parsed(text,
               [](const Link& l, const Address& a) {
                 return !a.loopback && !has_credentials(l) && !l.insecure();
               }),
        "is beyond this machine, and plain datagrams are unauthenticated and unencrypted: whoever "
        "reaches the port can move the robot",
        "make a key with farhand-keygen and add key_file: \"...\" to the link, stay on 127.0.0.1, "
        "or "
        "add insecure: true on a network you trust");
  }
}

void credential_rules(Rules& r) {
  rule<Link>(
      r, "key_file", [](const Link& l) { return l.has_key_file() && l.key_file().empty(); },
      "names no file", "name one made by farhand-keygen, or leave it out");
  rule<Link>(
      r, "insecure", [](const Link& l) { return l.has_key_file() && l.insecure(); },
      "contradicts key_file", "leave out one of the two");
  rule<Link>(
      r, "certificates",
      [](const Link& l) { return l.has_certificates() && (l.has_key_file() || l.insecure()); },
      "contradicts key_file or insecure", "leave in one of them");
  using C = proto::Certificates;
  for (const char* name : {"authority_file", "certificate_file", "private_key_file"}) {
    const auto* field = C::descriptor()->FindFieldByName(name);
    rule<C>(
        r, name,
        [field](const C& c) {
          const auto& reflection = *c.GetReflection();
          return reflection.HasField(c, field) && reflection.GetString(c, field).empty();
        },
        "names no file", "name one made by farhand-keygen --certificates");
  }
}

void endpoint_rules(Rules& r) {
  rule<Link>(
      r, "slave_address",
      parsed(&Link::slave_address, [](const Link&, const Address& a) { return a.port == 0; }),
      "has port 0, so the master would not know where to send", "give a port from 1 to 65535");
  rule<Link>(r, "observer_address",
             parsed(&Link::observer_address,
                    [](const Link& l, const Address& a) {
                      const auto slave = parse_address(l.slave_address());
                      return a.port == 0 || (slave && slave->port == a.port);
                    }),
             "has port 0 or that of slave_address, so observers would not reach it",
             "give another port, from 1 to 65535");
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
      r, "stale_ms", [](const Link& l) { return l.stale_ms() >= l.lost_ms(); },
      "is not less than lost_ms",
      "motion must hold before the peer counts as gone: lower it, or raise lost_ms");
  rule<Link>(
      r, "max_late_ms",
      [](const Link& l) { return l.has_max_late_ms() && l.max_late_ms() < l.stale_ms(); },
      "is less than stale_ms, so what ends a pause that is borne would be refused",
      "raise it, lower stale_ms, or leave it out");
  using I = proto::Impairment;
  rule<I>(
      r, "jitter_ms",
      [](const I& i) { return i.jitter() != I::GAMMA && i.jitter_ms() > i.delay_ms(); },
      "around the delay exceeds it, and nothing arrives before it was sent",
      "lower it, raise delay_ms, or use jitter: GAMMA, which only adds to the delay");
  rule<I>(
      r, "burst_leave_ratio",
      [](const I& i) { return i.burst_enter_ratio() > 0 && i.burst_leave_ratio() == 0; },
      "means that the first burst of losses never ends", "give more than 0");
  using B = proto::Blackout;
  rule<B>(
      r, "period_s", [](const B& b) { return b.period_s() > 0 && b.period_s() <= b.length_s(); },
      "is not more than length_s, so nothing ever passes", "raise it, or leave it out");
}

}  // namespace

void add_slave_rules(SceneRules& rules) {
  slave_rules(rules);
  arm_rules(rules);
  address_rules(rules);
  credential_rules(rules);
  endpoint_rules(rules);
  link_rules(rules);
}

}  // namespace farhand
