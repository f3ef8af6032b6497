#include "common/loop_report.hpp"

#include <spdlog/fmt/fmt.h>

namespace farhand {
namespace {

double us(Duration d) {
  return static_cast<double>(d.count()) * 1e-3;
}

std::string row(const char* name, const Histogram& h) {
  if (h.count() == 0) return {};
  return fmt::format("  {:<22}{:>10.1f}{:>10.1f}{:>10.1f}{:>10.1f}\n", name, us(h.quantile(0.5)),
                     us(h.quantile(0.99)), us(h.quantile(0.999)), us(h.max()));
}

}  // namespace

void LoopReport::add(const LoopTiming& t, const LinkStatus& status) noexcept {
  woken_late.add(t.woken_late);
  read.add(t.read);
  compute.add(t.compute);
  link.add(t.link);
  write.add(t.write);
  busy.add(t.read + t.compute + t.link + t.write);
  if (status.round_trip_known) round_trip.add(status.round_trip);
  if (t.answered) motion_to_force.add(t.compute + t.link + t.wait);
  ++ticks;
  overruns += t.overrun ? 1 : 0;
  overrun_own += t.overrun_own;
  overrun_machine += t.overrun_machine;
  last = status;
}

std::string LoopReport::table() const {
  std::string out = fmt::format("  {:<22}{:>10}{:>10}{:>10}{:>10}\n", "time [us]", "median", "99 %",
                                "99.9 %", "worst");
  out += row("woken late", woken_late);
  out += row("read device", read);
  out += row("compute tick", compute);
  out += row("link", link);
  out += row("write device", write);
  out += row("busy, whole tick", busy);
  out += row("round trip", round_trip);
  out += row("motion to force", motion_to_force);
  if (motion_to_force.count() > 0)
    out += fmt::format("  answered within the tick {} of {}\n", motion_to_force.count(), ticks);
  out += fmt::format(
      "  overruns {} (late by our own CPU time {:.1f} us, by the machine {:.1f} us in all)\n",
      overruns, us(overrun_own), us(overrun_machine));
  out += fmt::format("  datagrams received {}, dropped {}, lost {}, reordered {}, not sent {}\n",
                     last.received, last.dropped, last.lost, last.reordered, last.not_sent);
  if (last.round_trip_known)
    out += fmt::format(
        "  at the end: way here {:.1f} us, jitter {:.1f} us, clock offset known to {:.1f} us, "
        "drift {:.2f} ppm\n",
        us(last.transit), us(last.jitter), us(last.clock_uncertainty), 1e6 * last.clock_drift);
  return out;
}

std::string refusal_sentence(const PeerRefusal& refusal, std::uint64_t own_scene_hash) {
  switch (refusal.reason) {
    case PeerRefusal::Reason::none:
      return {};
    case PeerRefusal::Reason::version:
      return fmt::format(
          "the partner speaks protocol version {}, this program {}: install the same version on "
          "both sides",
          refusal.peer_version, kProtocolVersion);
    case PeerRefusal::Reason::scene:
      return fmt::format(
          "the partner runs another scene (shared part {:016x}, here {:016x}): start both sides "
          "with the same file",
          refusal.peer_scene_hash, own_scene_hash);
    case PeerRefusal::Reason::led:
      return "the slave is led by another master: stop that one, or start this one with "
             "--take-over";
    case PeerRefusal::Reason::taken_over:
      return "another master took over: this one ends";
  }
  return {};
}

}  // namespace farhand
