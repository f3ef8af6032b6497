// What the records of both sides have in common.
#pragma once

#include "common/loop_report.hpp"
#include "common/mode.hpp"
#include "common/realtime.hpp"
#include "common/recording_file.hpp"
#include "proto/record.pb.h"

namespace farhand {

// A recording's numbers are the states' own.
static_assert(static_cast<int>(Method::mmt) == record::METHOD_MMT &&
              record::Method_ARRAYSIZE == kMethods);
static_assert(static_cast<int>(Mode::stopped) == record::MODE_STOPPED &&
              static_cast<int>(Mode::holding) == record::MODE_HOLDING &&
              static_cast<int>(Reason::silent) == record::REASON_SILENT &&
              static_cast<int>(Reason::no_attitude) == record::REASON_NO_ATTITUDE &&
              record::Reason_ARRAYSIZE == kReasons);

inline float microseconds(Duration d) noexcept {
  return plotted<12>(static_cast<double>(d.count()) * 1e-3);
}

template <typename Record>
void set_timing(Record& to, const LoopTiming& t) {
  to.set_woken_late_us(microseconds(t.woken_late));
  to.set_read_us(microseconds(t.read));
  to.set_compute_us(microseconds(t.compute));
  to.set_link_us(microseconds(t.link));
  to.set_wait_us(microseconds(t.wait));
  to.set_write_us(microseconds(t.write));
  to.set_overrun(t.overrun);
  to.set_overrun_own_us(microseconds(t.overrun_own));
  to.set_overrun_machine_us(microseconds(t.overrun_machine));
}

template <typename Record>
void set_link(Record& to, const LinkStatus& s) {
  to.set_round_trip_us(s.round_trip_known ? microseconds(s.round_trip) : 0);
  to.set_transit_us(microseconds(s.transit));
  to.set_jitter_us(microseconds(s.jitter));
  to.set_clock_offset_ns(s.clock_offset.count());
  to.set_clock_uncertainty_us(microseconds(s.clock_uncertainty));
  to.set_clock_drift_ppm(plotted<12>(1e6 * s.clock_drift));
  to.set_received(s.received);
  to.set_dropped(s.dropped);
  to.set_lost(s.lost);
  to.set_reordered(s.reordered);
  to.set_not_sent(s.not_sent);
}

}  // namespace farhand
