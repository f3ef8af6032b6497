#include <spdlog/fmt/fmt.h>

#include <nlohmann/json.hpp>

#include "master/status.hpp"
#include "slave/status.hpp"
#include "tests/loop/run.hpp"

namespace farhand {
namespace {

using Json = nlohmann::ordered_json;

std::string millimetres_row(const char* name, const Rms& e) {
  if (e.count == 0) return {};
  return fmt::format("  {:<22} {:8.3f} mm rms  {:8.3f} mm peak\n", name, e.value() * 1e3,
                     e.peak * 1e3);
}

std::string wrench_row(const char* name, const WrenchRms& e) {
  if (e.axes[0].count == 0) return {};
  const auto rms = [&](std::size_t i) { return e.axes[i].value(); };
  return fmt::format("  {:<11} {:6.3f} {:6.3f} {:6.3f} N rms  {:8.2f} {:6.2f} {:6.2f} mN m rms\n",
                     name, rms(0), rms(1), rms(2), rms(3) * 1e3, rms(4) * 1e3, rms(5) * 1e3);
}

std::string settling_rows(const RunResult& r) {
  std::string out;
  for (const Settling& s : r.settling)
    out += fmt::format("  from {:5.2f} s: within 1.5 mm after {:.2f} s, peak error {:.2f} mm\n",
                       s.at_s, s.settled_after_s, s.peak_m * 1e3);
  return out;
}

std::string link_row(const char* name, const LinkCounters& c) {
  std::string out = fmt::format("  {} received {}, accepted {}", name, c.received, c.accepted());
  for (std::size_t v = 1; v < kVerdicts; ++v)
    if (c.by_verdict[v] > 0)
      out += fmt::format(", {} {}", to_string(static_cast<Verdict>(v)), c.by_verdict[v]);
  return out + "\n";
}

Json json(const Rms& e) {
  return {{"rms", e.value()}, {"peak", e.peak}, {"samples", e.count}};
}

Json json(const WrenchRms& e) {
  Json out = Json::array();
  for (const Rms& axis : e.axes) out.push_back(json(axis));
  return out;
}

Json json(const LimitCounts& limits) {
  Json out = Json::object();
  for (int bit = 0; bit < kLimitCount; ++bit) out[limit_name(bit)] = limits.ticks[bit];
  return out;
}

Json modes(const std::array<std::uint64_t, kModes>& ticks) {
  Json out = Json::object();
  for (std::size_t m = 0; m < ticks.size(); ++m) out[to_string(static_cast<Mode>(m))] = ticks[m];
  return out;
}

Json json(const LinkCounters& c) {
  Json out = {{"received", c.received}, {"accepted", c.accepted()}, {"dropped", c.dropped()}};
  for (std::size_t v = 1; v < kVerdicts; ++v)
    out["dropped_because"][to_string(static_cast<Verdict>(v))] = c.by_verdict[v];
  return out;
}

}  // namespace

std::string to_text(const RunResult& r) {
  std::string out = "master\n" + summary_rows(r.master) + settling_rows(r);
  if (r.slave.ticks > 0) {
    out += "slave\n" + summary_rows(r.slave);
    out += "handle to robot, true poses\n" + millimetres_row("free", r.handle_to_robot_free) +
           millimetres_row("in contact", r.handle_to_robot_contact);
    if (r.peak_penetration > 0)
      out += fmt::format("  deepest penetration    {:8.3f} mm\n", r.peak_penetration * 1e3);
    const std::string user = wrench_row("free", r.user_to_environment_free) +
                             wrench_row("in contact", r.user_to_environment_contact);
    if (!user.empty()) out += "true F_u - F_e, x y z of the handle's axes\n" + user;
    out += "link\n" + link_row("master", r.master_link) + link_row("slave ", r.slave_link);
    if (r.quality.round_trip_known)
      out += fmt::format("  round trip {:.1f} us, jitter {:.1f} us, lost {}, reordered {}\n",
                         static_cast<double>(r.quality.round_trip.count()) * 1e-3,
                         static_cast<double>(r.quality.jitter.count()) * 1e-3, r.quality.lost,
                         r.quality.reordered);
  }
  out += fmt::format("run\n  {:g} s simulated in {:.3f} s, {:.0f} x real time, digest {:016x}\n",
                     r.simulated_s, r.wall_s, r.simulated_s / r.wall_s, r.digest);
  out += r.good() ? std::string("  no limit was violated\n")
                  : fmt::format("  VIOLATIONS {}\n", r.violations);
  for (const Violation& v : r.first_violations)
    out += fmt::format("    at {:.4f} s: {}\n", v.at_s, v.what);
  return out;
}

std::string to_json(const RunResult& r) {
  Json out;
  out["simulated_s"] = r.simulated_s;
  out["wall_s"] = r.wall_s;
  out["digest"] = fmt::format("{:016x}", r.digest);
  out["violations"] = r.violations;
  for (const Violation& v : r.first_violations)
    out["first_violations"].push_back({{"at_s", v.at_s}, {"what", v.what}});
  out["master"] = {{"ticks", r.master.ticks},
                   {"ticks_in_mode", modes(r.master.ticks_in_mode)},
                   {"force_error_free_newton", json(r.master.force_free)},
                   {"force_error_contact_newton", json(r.master.force_contact)},
                   {"force_on_hand_newton", json(r.master.force_felt)},
                   {"peak_control_force_newton", r.master.peak_control_force},
                   {"limited_ticks", json(r.master.limits)},
                   {"link", json(r.master_link)}};
  for (const Settling& s : r.settling)
    out["settling"].push_back(
        {{"at_s", s.at_s}, {"settled_after_s", s.settled_after_s}, {"peak_m", s.peak_m}});
  if (r.slave.ticks == 0) return out.dump(2) + "\n";
  out["slave"] = {{"ticks", r.slave.ticks},
                  {"ticks_in_mode", modes(r.slave.ticks_in_mode)},
                  {"coupled_ticks", r.slave.coupled_ticks},
                  {"tracking_free_m", json(r.slave.position_free)},
                  {"tracking_contact_m", json(r.slave.position_contact)},
                  {"tracking_free_rad", json(r.slave.rotation_free)},
                  {"tracking_contact_rad", json(r.slave.rotation_contact)},
                  {"contact_force_newton", json(r.slave.force)},
                  {"peak_penetration_m", r.peak_penetration},
                  {"limited_ticks", json(r.slave.limits)},
                  {"link", json(r.slave_link)}};
  out["handle_to_robot_m"] = {{"free", json(r.handle_to_robot_free)},
                              {"contact", json(r.handle_to_robot_contact)}};
  out["user_to_environment"] = {{"free", json(r.user_to_environment_free)},
                                {"contact", json(r.user_to_environment_contact)}};
  return out.dump(2) + "\n";
}

}  // namespace farhand
