#include "master/status.hpp"

#include <spdlog/fmt/fmt.h>
#include <spdlog/spdlog.h>

#include <numbers>

#include "common/summary_rows.hpp"

namespace farhand {
namespace {

constexpr double kDegree = 180 / std::numbers::pi;

// For the live line; empty without an AHRS.
std::string ahrs_words(const MasterTick& t) {
  if (!t.has_ahrs) return {};
  constexpr const char* kWords[] = {"silent", "starting", "ok", "LOST, orientation held"};
  return fmt::format("  AHRS {}, tilt +-{:.1f} yaw +-{:.1f} deg", kWords[static_cast<int>(t.ahrs)],
                     t.tilt_sigma * kDegree, t.yaw_sigma * kDegree);
}

std::string live_line(const MasterRecord& r, std::uint64_t overruns) {
  const Vec3 p = r.tick.handle.X_MH.p * 1e3;
  return fmt::format(
      "{:<7} handle ({:6.1f} {:6.1f} {:6.1f}) mm  felt {:5.2f} N  round trip {:6.1f} us  jitter "
      "{:6.1f} us  lost {}  reordered {}  overruns {}  dropped {}{}",
      to_string(r.tick.mode), p.x(), p.y(), p.z(), r.tick.F_G.force.norm(),
      static_cast<double>(r.link.round_trip.count()) * 1e-3,
      static_cast<double>(r.link.jitter.count()) * 1e-3, r.link.lost, r.link.reordered, overruns,
      r.link.dropped, ahrs_words(r.tick));
}

}  // namespace

std::string summary_rows(const MasterSummary& s) {
  std::string out = mode_row(s.ticks, s.ticks_in_mode);
  if (s.turn_ticks > 0)
    out += fmt::format("  handle to be turned    {} ticks, by at most {:.1f} deg\n", s.turn_ticks,
                       s.largest_turn * kDegree);
  if (s.ahrs_lost_ticks > 0)
    out += fmt::format("  orientation held       {} ticks, no sample of the attitude sensor\n",
                       s.ahrs_lost_ticks);
  if (s.force_free.count > 0)
    out += fmt::format("  F_u - F_e free         {:8.3f} N rms   {:8.3f} N peak\n",
                       s.force_free.value(), s.force_free.peak);
  if (s.force_contact.count > 0)
    out += fmt::format("  F_u - F_e in contact   {:8.3f} N rms   {:8.3f} N peak\n",
                       s.force_contact.value(), s.force_contact.peak);
  if (s.force_felt.count > 0)
    out += fmt::format("  force on the hand      {:8.3f} N rms   {:8.3f} N peak\n",
                       s.force_felt.value(), s.force_felt.peak);
  if (s.position_error.count > 0)
    out += fmt::format(
        "  position control       last off target by over 1.5 mm at {:.2f} s, peak force {:.2f} "
        "N\n",
        s.last_outside_s, s.peak_control_force);
  return out + limit_row(s.limits);
}

// A slave never answers a stranger, nor a master with another scene, and one without our key says
// nothing that we understand: only the silence can be told.
void MasterStatus::watch_silence(const MasterRecord& r) {
  constexpr Duration kPatience = std::chrono::seconds(3);
  if (summary_.ticks == 1) first_ = r.tick.now;
  if (silence_told_ || r.tick.position_controlled || r.link.received > 0 ||
      r.tick.now - first_ < kPatience)
    return;
  silence_told_ = true;
  spdlog::warn(
      "no answer from the slave: is it running, at that address, with the same scene and key?");
}

// The operator sits here: what ails the robot is told here too.
void MasterStatus::watch_slave(const MasterRecord& r) {
  const Reason fault = r.tick.slave_mode == Mode::fault ? r.tick.slave_reason : Reason::none;
  if (fault != Reason::none && fault != slave_fault_)
    spdlog::error("the robot's side: FAULT: {}", to_string(fault));
  slave_fault_ = fault;
}

// Where the method is chosen as it runs, the operator is told which and why.
void MasterStatus::watch_method(const MasterRecord& r) {
  if (r.tick.method_reason == method_reason_) return;
  method_reason_ = r.tick.method_reason;
  spdlog::info("compensation: {}: {}", to_string(r.tick.out.method), method_reason_);
}

// What the robot does about its orientation, where nothing else would tell.
void MasterStatus::watch_ahrs(const MasterRecord& r) {
  const AhrsState before = ahrs_;
  ahrs_ = r.tick.ahrs;
  if (ahrs_ == before) return;
  if (ahrs_ == AhrsState::lost)
    spdlog::warn(
        "attitude sensor: no sample comes: the robot keeps its orientation and follows in "
        "translation alone; check the sensor's cable");
  else if (before == AhrsState::lost)
    spdlog::info("attitude sensor: samples are back, the orientation returns slowly");
  else if (ahrs_ == AhrsState::ok)
    spdlog::info("attitude sensor: it knows how the grip is turned");
}

void MasterStatus::advise(const std::string& user) {
  spdlog::info("device: {}", user);
}

void MasterStatus::add(const MasterRecord& r) {
  summary_.add(r.tick);
  watch_silence(r);
  watch_slave(r);
  watch_method(r);
  watch_ahrs(r);
  watch_.add(r.tick, r.timing, r.link, [&] { return live_line(r, watch_.report().overruns); });
}

std::string MasterStatus::final_table(std::uint64_t records_lost) {
  return "master\n" + summary_rows(summary_) + watch_.end(records_lost);
}

}  // namespace farhand
