// The operating system as the loops need it: a monotonic clock, sleep to an absolute instant,
// real-time scheduling, an orderly end, and whose fault an overrun was.
#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include "common/time.hpp"

namespace farhand {

TimePoint monotonic_now() noexcept;
// Returns at once when `until` has passed. Interrupted by a signal, returns early. The last `spin`
// of it the clock is watched instead, at the price of the processor: no wake-up can be late then.
void sleep_until(TimePoint until, Duration spin = {}) noexcept;

struct RealtimeConfig {
  std::optional<int> cpu;       // the loop's thread runs there only
  Duration spin{};              // of each sleep and of each wait for a datagram
  bool allow_degraded = false;  // real hardware runs although something was refused
};

// 0 or an errno.
int lock_memory() noexcept;
int schedule_fifo(int priority) noexcept;  // the calling thread

// A sentence with the remedy for their errors.
std::string memory_refusal(int error);
std::string scheduling_refusal(int error);

// The calling thread becomes the loop's: on its processor, memory locked, SCHED_FIFO at `priority`.
// What was refused comes back as sentences with the remedy: the price of going on is jitter.
std::vector<std::string> enter_realtime(const RealtimeConfig& config, int priority);

// Why a device must not be enabled, with the remedy, or nothing: real hardware wants all that
// enter_realtime asks for, unless the scene allows degraded running.
std::optional<std::string> degraded_refusal(bool real_device,
                                            const std::vector<std::string>& refused,
                                            bool allow_degraded);

// SIGINT and SIGTERM ask for an orderly end instead of killing the process; a file that may not
// grow, or a pipe without a reader, does not end it either.
void catch_stop_signals() noexcept;
bool stop_requested() noexcept;

// Splits the time a late tick took into the processor time it used itself and the time the machine
// withheld from it. Reading the thread's processor clock is a system call, so it is read only after
// an overrun: what all ticks since the last reading were busy, less the processor time in between,
// is what was withheld, and on-time ticks are hardly withheld anything.
class OverrunSplit {
 public:
  struct Shares {
    Duration own{};
    Duration machine{};
  };
  OverrunSplit() noexcept;
  // After each tick: how long it was busy, waiting and sleeping not counted.
  void busy(Duration time) noexcept { busy_ += time; }
  // After a tick that ended late: `late` after its deadline, of which `woken_late` were lost before
  // it began.
  Shares split(Duration late, Duration woken_late) noexcept;

 private:
  Duration busy_{};
  Duration cpu_{};
};

// What one turn of a loop cost, for the record. Durations of stages that did not run stay zero.
struct LoopTiming {
  Duration woken_late{};  // wake-up after the planned instant
  Duration read{};        // device or robot
  Duration compute{};     // the tick itself: sample and actuate, or tick
  Duration link{};        // encode, send, receive, decode
  Duration wait{};        // for the answer, not busy
  Duration write{};
  bool answered = false;  // the wait brought the answer to this very sample
  bool overrun = false;
  Duration overrun_own{};
  Duration overrun_machine{};
};

}  // namespace farhand
