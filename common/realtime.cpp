#include "common/realtime.hpp"

#include <pthread.h>
#include <sched.h>
#include <sys/mman.h>
#include <time.h>

#include <algorithm>
#include <cerrno>
#include <csignal>
#include <cstring>

#include "common/processors.hpp"

namespace farhand {
namespace {

volatile std::sig_atomic_t g_stop = 0;

extern "C" void on_stop_signal(int) {
  g_stop = 1;
}

Duration to_duration(const timespec& t) noexcept {
  return std::chrono::seconds(t.tv_sec) + Duration(t.tv_nsec);
}

Duration thread_cpu_time() noexcept {
  timespec t{};
  clock_gettime(CLOCK_THREAD_CPUTIME_ID, &t);
  return to_duration(t);
}

}  // namespace

TimePoint monotonic_now() noexcept {
  timespec t{};
  clock_gettime(CLOCK_MONOTONIC, &t);
  return TimePoint(to_duration(t));
}

void sleep_until(TimePoint until, Duration spin) noexcept {
  const auto since = (until - spin).time_since_epoch();
  const auto whole = std::chrono::duration_cast<std::chrono::seconds>(since);
  const timespec t{.tv_sec = whole.count(), .tv_nsec = (since - whole).count()};
  if (clock_nanosleep(CLOCK_MONOTONIC, TIMER_ABSTIME, &t, nullptr) != 0) return;
  if (spin > Duration::zero())
    while (monotonic_now() < until) {
    }
}

int lock_memory() noexcept {
  return mlockall(MCL_CURRENT | MCL_FUTURE) == 0 ? 0 : errno;
}

int schedule_fifo(int priority) noexcept {
  const sched_param param{.sched_priority = priority};
  return pthread_setschedparam(pthread_self(), SCHED_FIFO, &param);
}

std::string memory_refusal(int error) {
  return std::string("memory is not locked (") + std::strerror(error) +
         "): page faults may delay ticks; raise the memlock limit or run with CAP_IPC_LOCK";
}

std::string scheduling_refusal(int error) {
  return std::string("no real-time scheduling (") + std::strerror(error) +
         "): other programs may delay ticks; raise the rtprio limit or run with CAP_SYS_NICE";
}

std::vector<std::string> enter_realtime(const RealtimeConfig& config, int priority) {
  std::vector<std::string> refused;
  if (config.cpu)
    if (const int error = run_on({*config.cpu}); error != 0)
      refused.push_back(processor_refusal(*config.cpu, error));
  if (const int error = lock_memory(); error != 0) refused.push_back(memory_refusal(error));
  if (const int error = schedule_fifo(priority); error != 0)
    refused.push_back(scheduling_refusal(error));
  return refused;
}

std::optional<std::string> degraded_refusal(bool real_device,
                                            const std::vector<std::string>& refused,
                                            bool allow_degraded) {
  if (!real_device || refused.empty() || allow_degraded) return {};
  return "the device stays off, for " + refused.front() +
         "; or say realtime { allow_degraded: true } in the scene";
}

void catch_stop_signals() noexcept {
  struct sigaction action {};
  action.sa_handler = on_stop_signal;
  sigaction(SIGINT, &action, nullptr);
  sigaction(SIGTERM, &action, nullptr);
  // A recording that grows too large, or whose reader is gone, is an error of write().
  action.sa_handler = SIG_IGN;
  sigaction(SIGXFSZ, &action, nullptr);
  sigaction(SIGPIPE, &action, nullptr);
}

bool stop_requested() noexcept {
  return g_stop != 0;
}

OverrunSplit::OverrunSplit() noexcept : cpu_(thread_cpu_time()) {}

OverrunSplit::Shares OverrunSplit::split(Duration late, Duration woken_late) noexcept {
  const Duration cpu = thread_cpu_time();
  const Duration withheld = std::max(busy_ - (cpu - cpu_), Duration(0));
  cpu_ = cpu;
  busy_ = Duration(0);
  const Duration machine = std::clamp(woken_late + withheld, Duration(0), late);
  return {.own = late - machine, .machine = machine};
}

}  // namespace farhand
