// What a real-time loop tells of itself: time by stage, overruns and whose they were, and the link.
// Fed from the recorder's thread, printed at the end and in the live status line.
#pragma once

#include <cstdint>
#include <string>

#include "common/histogram.hpp"
#include "common/link.hpp"
#include "common/realtime.hpp"

namespace farhand {

// The link's counters at one tick.
struct LinkStatus {
  Duration round_trip{};
  bool round_trip_known = false;
  Duration transit{};  // of the newest message, as estimated; 0 while unknown
  Duration jitter{};
  Duration clock_offset{};  // partner's monotonic clock minus ours; 0 while unknown
  Duration clock_uncertainty{};
  double clock_drift = 0;  // of the offset, per second
  std::uint64_t received = 0;
  std::uint64_t dropped = 0;
  std::uint64_t lost = 0;
  std::uint64_t reordered = 0;
  std::uint64_t not_sent = 0;  // the socket had no room
  PeerRefusal refusal;
};

template <typename L>
LinkStatus link_status(const L& link, std::uint64_t not_sent) noexcept {
  const LinkQuality& q = link.quality();
  const ClockEstimate clock = link.clock();
  return {.round_trip = q.round_trip,
          .round_trip_known = q.round_trip_known,
          .transit = link.newest() != nullptr ? link.newest()->transit : Duration::zero(),
          .jitter = q.jitter,
          .clock_offset = clock.offset,
          .clock_uncertainty = clock.uncertainty,
          .clock_drift = clock.drift,
          .received = link.counters().received,
          .dropped = link.counters().dropped(),
          .lost = q.lost,
          .reordered = q.reordered,
          .not_sent = not_sent,
          .refusal = link.peer_refusal()};
}

struct LoopReport {
  Histogram woken_late, read, compute, link, write, busy, round_trip;
  Histogram motion_to_force;  // of answered samples, the own device not counted
  std::uint64_t ticks = 0, overruns = 0;
  Duration overrun_own{}, overrun_machine{};
  LinkStatus last;

  void add(const LoopTiming& timing, const LinkStatus& status) noexcept;
  // Table rows, one stage a line, in microseconds: median, 99 %, 99.9 %, worst.
  std::string table() const;
};

// One sentence for the user when the partner was refused, with the remedy; empty otherwise.
std::string refusal_sentence(const PeerRefusal& refusal, std::uint64_t own_scene_hash);

}  // namespace farhand
