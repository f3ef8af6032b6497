#include "slave/status.hpp"

#include <spdlog/fmt/fmt.h>

#include <numbers>

#include "common/summary_rows.hpp"

namespace farhand {
namespace {

std::string live_line(const SlaveRecord& r, std::uint64_t overruns) {
  const Vec3 p = r.tick.X_SE.p * 1e3;
  return fmt::format(
      "{:<7} tool ({:6.1f} {:6.1f} {:6.1f}) mm  off target {:5.2f} mm  contact {:5.2f} N  jitter "
      "{:6.1f} us  lost {}  overruns {}",
      to_string(r.tick.mode), p.x(), p.y(), p.z(),
      (r.tick.X_SE_target.p - r.tick.X_SE.p).norm() * 1e3, r.tick.F_E_S.force.norm(),
      static_cast<double>(r.link.jitter.count()) * 1e-3, r.link.lost, overruns);
}

constexpr double kDegree = 180 / std::numbers::pi;

std::string tracking_row(const char* where, const Rms& position, const Rms& rotation) {
  if (position.count == 0) return {};
  return fmt::format(
      "  tracking {:<13} {:8.3f} mm rms  {:8.3f} mm peak  {:7.3f} deg rms  {:7.3f} deg peak\n",
      where, position.value() * 1e3, position.peak * 1e3, rotation.value() * kDegree,
      rotation.peak * kDegree);
}

}  // namespace

std::string summary_rows(const SlaveSummary& s) {
  std::string out = mode_row(s.ticks, s.ticks_in_mode);
  out += tracking_row("free", s.position_free, s.rotation_free);
  out += tracking_row("in contact", s.position_contact, s.rotation_contact);
  if (s.largest_turn > 0)
    out += fmt::format("  coupled again          within {:.1f} deg of the handle's orientation\n",
                       s.largest_turn * kDegree);
  if (s.force.count > 0)
    out += fmt::format("  contact force          {:8.3f} N rms   {:8.3f} N peak\n", s.force.value(),
                       s.force.peak);
  if (s.left_out > 0)
    out += fmt::format("  answers left out       {} of {}\n", s.left_out, s.ticks);
  return out + limit_row(s.limits);
}

void SlaveStatus::add(const SlaveRecord& r) {
  summary_.add(r.tick);
  watch_.add(r.tick, r.timing, r.link, [&] { return live_line(r, watch_.report().overruns); });
}

std::string SlaveStatus::final_table(std::uint64_t records_lost) {
  return "slave\n" + summary_rows(summary_) + watch_.end(records_lost);
}

}  // namespace farhand
