#include "common/doctor_process.hpp"

#include <spdlog/fmt/fmt.h>

#include "common/histogram.hpp"
#include "common/realtime.hpp"

namespace farhand::doctor {
namespace {

constexpr bool sanitized() {
#if defined(__SANITIZE_ADDRESS__) || defined(__SANITIZE_THREAD__)
  return true;
#elif defined(__has_feature)
  return __has_feature(address_sanitizer) || __has_feature(thread_sanitizer);
#else
  return false;
#endif
}

double in_us(Duration d) {
  return 1e6 * seconds(d);
}

}  // namespace

Build this_build() noexcept {
  Build out{.optimised = false, .assertions = true, .sanitizer = sanitized()};
#ifdef __OPTIMIZE__
  out.optimised = true;
#endif
#ifdef NDEBUG
  out.assertions = false;
#endif
  return out;
}

Finding build(const Build& build) {
  std::string slow;
  const auto add = [&](bool is, const char* what) {
    if (is) slow += (slow.empty() ? "" : ", ") + std::string(what);
  };
  add(!build.optimised, "not optimised");
  add(build.assertions, "assertions on");
  add(build.sanitizer, "sanitizers on");
  if (slow.empty()) return {Level::ok, "build", "optimised, no assertions"};
  return {Level::warning, "build", slow + ": run what cmake --preset release builds"};
}

Finding scheduling(int error, int priority, Level refused) {
  if (error == 0) return {Level::ok, "scheduling", fmt::format("SCHED_FIFO at {}", priority)};
  return {refused, "scheduling", scheduling_refusal(error)};
}

Finding memory_lock(int error, Level refused) {
  if (error == 0) return {Level::ok, "memory lock", "granted"};
  return {refused, "memory lock", memory_refusal(error)};
}

Lateness measure_lateness(Duration period, Duration spin, int sleeps) noexcept {
  Histogram late;
  TimePoint next = monotonic_now() + period;
  for (int i = 0; i < sleeps && !stop_requested(); ++i) {
    sleep_until(next, spin);
    const Duration by = monotonic_now() - next;
    late.add(by);
    next += (by / period + 1) * period;
  }
  return {.median = late.quantile(0.5), .p99 = late.quantile(0.99), .worst = late.max()};
}

Finding wake_up(const Lateness& late, Duration period) {
  const Duration most = period / 2, usual = period / 10;
  const std::string text = fmt::format(
      "median {:.1f} us late, 99 % {:.1f} (limit {:g}), worst {:.1f} (limit {:g})",
      in_us(late.median), in_us(late.p99), in_us(usual), in_us(late.worst), in_us(most));
  if (late.p99 <= usual && late.worst <= most) return {Level::ok, "wake-up", text};
  return {Level::warning, "wake-up",
          text +
              ": see to the warnings above, end other programs, give the loop a processor of "
              "its own (realtime { cpu })"};
}

}  // namespace farhand::doctor
