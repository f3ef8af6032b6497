// What the doctor finds out by trying: how this program was built, what the system grants it, and
// how late it wakes.
#pragma once

#include "common/doctor.hpp"
#include "common/time.hpp"

namespace farhand::doctor {

struct Build {
  bool optimised = true;
  bool assertions = false;
  bool sanitizer = false;
};
Build this_build() noexcept;
Finding build(const Build& build);

// `error` is that of schedule_fifo and of lock_memory; `refused` how grave one is.
Finding scheduling(int error, int priority, Level refused = Level::warning);
Finding memory_lock(int error, Level refused = Level::warning);

// Of sleeps to the begin of each period, in the mode the calling thread is in.
struct Lateness {
  Duration median{}, p99{}, worst{};
};
// Ends early when a stop is requested.
Lateness measure_lateness(Duration period, Duration spin, int sleeps) noexcept;

// A warning if 1 % are later than a tenth of the period, or one than half of it, which is an
// overrun.
Finding wake_up(const Lateness& late, Duration period);

}  // namespace farhand::doctor
