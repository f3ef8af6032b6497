// Time of the calling thread's own making: while it is on, the C library's clocks, sleeps and waits
// for sockets answer from it, and other threads notice nothing. Include it in one source file of a
// test program: it defines clock_gettime, clock_nanosleep, ppoll, poll
// and timerfd_settime, of which the thread has one timer.
#pragma once

#include <poll.h>
#include <sys/syscall.h>
#include <sys/timerfd.h>
#include <time.h>
#include <unistd.h>

#include <algorithm>
#include <cerrno>
#include <utility>

#include "common/time.hpp"

namespace farhand {

struct VirtualClock {
  bool on = false;
  Duration now{};
  Duration processor{};  // time of the thread's own
  Duration reading{};    // what each reading of the clock takes

  // What happens once, the next time that the thread waits in this way.
  enum class Wait { sleep, socket };
  Wait at = Wait::sleep;
  Duration late{};           // the wait is longer by so much
  Duration stall{};          // so long between the first two readings of the clock after it
  bool busy = false;         // the thread works while it stalls
  bool interrupted = false;  // the sleep ends at once

  Wait last = Wait::sleep;
  int readings = 0;       // since then
  int polls_at_once = 0;  // that would not have waited
  Duration asleep_until{};
  Duration deadline{};  // of the timer

  Duration read() noexcept {
    if (++readings == 2 && last == at) {
      const Duration length = std::exchange(stall, Duration::zero());
      now += length;
      if (busy) processor += length;
    }
    return std::exchange(now, now + reading);
  }
  int sleep(Duration until) noexcept {
    asleep_until = until;
    if (std::exchange(interrupted, false)) return EINTR;
    wait(Wait::sleep, std::max(now, until));
    return 0;
  }
  void poll(Duration timeout) noexcept {
    if (timeout == Duration::zero()) ++polls_at_once;
    wait(Wait::socket, now + timeout);
  }
  void poll_timer() noexcept { wait(Wait::socket, deadline); }

 private:
  void wait(Wait way, Duration until) noexcept {
    const bool lasts = until > now;
    now = until;
    if (way == at && lasts) now += std::exchange(late, Duration::zero());
    last = way;
    readings = 0;
  }
};

inline thread_local VirtualClock virtual_clock;

inline Duration to_duration(const timespec& t) noexcept {
  return std::chrono::seconds(t.tv_sec) + Duration(t.tv_nsec);
}
inline timespec to_timespec(Duration d) noexcept {
  const auto whole = std::chrono::floor<std::chrono::seconds>(d);
  return {.tv_sec = whole.count(), .tv_nsec = (d - whole).count()};
}

}  // namespace farhand

// NOLINTBEGIN(readability-identifier-naming): the C library's own names
extern "C" {
int clock_gettime(clockid_t clock, timespec* time) noexcept {
  auto& v = farhand::virtual_clock;
  const bool ours = v.on && (clock == CLOCK_MONOTONIC || clock == CLOCK_THREAD_CPUTIME_ID);
  if (!ours) return static_cast<int>(syscall(SYS_clock_gettime, clock, time));
  *time = farhand::to_timespec(clock == CLOCK_MONOTONIC ? v.read() : v.processor);
  return 0;
}

int clock_nanosleep(clockid_t clock, int flags, const timespec* until, timespec* left) {
  if (farhand::virtual_clock.on && clock == CLOCK_MONOTONIC && flags == TIMER_ABSTIME)
    return farhand::virtual_clock.sleep(farhand::to_duration(*until));
  return syscall(SYS_clock_nanosleep, clock, flags, until, left) == 0 ? 0 : errno;
}

// Nothing arrives while the clock is virtual.
int ppoll(pollfd* fds, nfds_t count, const timespec* timeout, const sigset_t* mask) {
  if (farhand::virtual_clock.on && timeout != nullptr) {
    farhand::virtual_clock.poll(farhand::to_duration(*timeout));
    return 0;
  }
  timespec copy = timeout != nullptr ? *timeout : timespec{};
  return static_cast<int>(
      syscall(SYS_ppoll, fds, count, timeout != nullptr ? &copy : nullptr, mask, _NSIG / 8));
}

int timerfd_settime(int timer, int flags, const itimerspec* to, itimerspec* from) noexcept {
  if (farhand::virtual_clock.on && (flags & TFD_TIMER_ABSTIME) != 0) {
    farhand::virtual_clock.deadline = farhand::to_duration(to->it_value);
    return 0;
  }
  return static_cast<int>(syscall(SYS_timerfd_settime, timer, flags, to, from));
}

// A socket and the timer.
int poll(pollfd* fds, nfds_t count, int timeout_ms) {
  if (farhand::virtual_clock.on && timeout_ms < 0) {
    farhand::virtual_clock.poll_timer();
    for (nfds_t i = 0; i < count; ++i) fds[i].revents = i == 0 ? short{0} : POLLIN;
    return 1;
  }
  return static_cast<int>(syscall(SYS_poll, fds, count, timeout_ms));
}
}
// NOLINTEND(readability-identifier-naming)
