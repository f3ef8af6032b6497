#include "common/line_rates.hpp"
#include "common/scene_rules.hpp"

namespace farhand {
namespace {

// From a motion to the arrival of the first sample after it [s].
double oldest(const proto::Ahrs& a) {
  return a.latency_ms() * 1e-3 + 1 / a.rate_hz();
}

void sensor_rules(SceneRules& r) {
  rule<proto::Master>(
      r, "ahrs", [](const proto::Master& m) { return m.has_ahrs() && m.has_twin_delta(); },
      "is for the Falcon; a twin_delta's motors tell how it is turned",
      "remove it, or use the falcon handle");
  using A = proto::Ahrs;
  rule<A>(
      r, "", [](const A& a) { return a.source_case() == A::SOURCE_NOT_SET; },
      "has no source of samples",
      "add serial { path: \"/dev/ttyUSB0\" }, or with sim_hand simulated {}");
  rule<A>(
      r, "simulated",
      [](const proto::Scene& s, const A& a) {
        return a.has_simulated() && !s.master().has_sim_hand();
      },
      "has no simulated hand to sit on", "use sim_hand {} as the device, or serial { ... }");
  rule<A>(
      r, "rate_hz", [](const proto::Scene& s, const A& a) { return a.rate_hz() > s.rate_hz(); },
      "is more than one sample per tick", "lower it to the scene's rate_hz or below");
  // The fusion turns on from a sample for 30 ms; two are left for what comes later than usual.
  rule<A>(
      r, "latency_ms", [](const A& a) { return oldest(a) > 0.028; },
      "and 1000 / rate_hz are together more than 28 ms, too old to turn on from",
      "lower it, or raise rate_hz");
  // It remembers 128 ticks, of which comparing encoders and accelerometer takes up to 37.
  rule<A>(
      r, "latency_ms",
      [](const proto::Scene& s, const A& a) { return oldest(a) * s.rate_hz() > 85; },
      "and 1000 / rate_hz are together more than 85 ticks, longer than is remembered",
      "lower it, or lower the scene's rate_hz");
  rule<A>(
      r, "up_in_master",
      [](const A& a) { return a.up_in_master_size() > 0 && norm(a.up_in_master()) < 1e-6; },
      "has no length", "give the direction that points up, such as [0, 1, 0]");
  using S = proto::AhrsSerial;
  rule<S>(
      r, "baud", [](const S& s) { return !line_runs_at(s.baud()); }, "is no rate of a serial line",
      std::string("give ") + kLineRatesListed);
}

// How a grip is turned is known of a Falcon's only by an AHRS; a simulated hand turns it only for a
// simulated one.
bool knows_turns(const proto::Scene& s) {
  return !s.master().has_falcon() || s.master().has_ahrs();
}
bool makes_turns(const proto::Scene& s) {
  return !s.master().has_falcon() || s.master().ahrs().has_simulated();
}
template <typename M>
void only_if(SceneRules& rules, bool (*turns)(const proto::Scene&), const char* remedy,
             std::initializer_list<const char*> fields) {
  for (const char* name : fields) {
    const auto* field = M::descriptor()->FindFieldByName(name);
    rule<M>(
        rules, name,
        [turns, field](const proto::Scene& s, const M& m) { return !turns(s) && given(m, *field); },
        "means nothing on a Falcon whose grip never turns", remedy);
  }
}

}  // namespace

void add_ahrs_rules(SceneRules& r) {
  sensor_rules(r);
  using W = proto::Workspace;
  only_if<W>(r, knows_turns, "remove it, add master.ahrs, or use twin_delta", {"rotation_lock"});
  only_if<W>(r, knows_turns, "remove it, or use twin_delta", {"alignment_deg"});
  rule<W>(
      r, "alignment_deg",
      [](const proto::Scene& s, const W& w) {
        return s.master().has_ahrs() && w.has_alignment_deg();
      },
      "would compare with an orientation that an ahrs counts anew from each start of the master",
      "remove it, or use twin_delta");
  const char* remedy = "remove it, add master.ahrs { simulated {} }, or use twin_delta";
  only_if<proto::Motion>(r, makes_turns, remedy, {"max_turn_rate_deg_per_s"});
  only_if<proto::Trace>(r, makes_turns, remedy, {"rotation_scale", "max_tilt_deg"});
  only_if<proto::Sine>(r, makes_turns, remedy, {"amplitude_deg"});
  only_if<proto::Reach>(r, makes_turns, remedy, {"turn_deg"});
}

}  // namespace farhand
