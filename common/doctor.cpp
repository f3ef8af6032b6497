#include "common/doctor.hpp"

#include <spdlog/fmt/fmt.h>

#include <algorithm>
#include <cstdio>

#include "common/doctor_link.hpp"
#include "common/doctor_machine.hpp"
#include "common/doctor_process.hpp"
#include "common/program.hpp"
#include "common/scene_realtime.hpp"

namespace farhand::doctor {
namespace {

const char* word(Level level) {
  return level == Level::ok ? "ok" : level == Level::warning ? "warning" : "problem";
}

auto count(const Findings& findings, Level level) {
  return std::count_if(findings.begin(), findings.end(),
                       [&](const Finding& f) { return f.level == level; });
}

void add(Findings& to, const Findings& more) {
  to.insert(to.end(), more.begin(), more.end());
}

// In the order in which a loop is entered, so that the last, the wake-ups, are those of the loop.
// refused: what it means that a loop would jitter.
Findings examine(const proto::Scene& scene, const RealtimeConfig& realtime, Level refused) {
  const std::filesystem::path root = "/";
  constexpr int kSleepSeconds = 1;
  // A tick is done after a quarter of the period, spinning apart.
  const double share = 0.25 + 2 * seconds(realtime.spin) * scene.rate_hz();
  const Processors allowed = own_processors();
  const int error = realtime.cpu ? run_on({*realtime.cpu}) : 0;
  Findings out{build(this_build()),
               processors(root, allowed, realtime.cpu, error),
               governor(root, own_processors()),
               clock_source(root),
               throttling(root, share),
               memory(root),
               memory_lock(lock_memory(), refused),
               scheduling(schedule_fifo(kLoopPriority), kLoopPriority, refused)};
  const Duration period = from_seconds(1 / scene.rate_hz());
  const auto before = stolen_time(root);
  const Lateness late =
      measure_lateness(period, realtime.spin, static_cast<int>(kSleepSeconds * scene.rate_hz()));
  out.push_back(wake_up(late, period));
  out.push_back(virtual_machine(root, before, stolen_time(root)));
  return out;
}

}  // namespace

std::string to_text(const Findings& findings) {
  std::string out;
  for (const Finding& f : findings)
    out += fmt::format("{:<8} {:<15} {}\n", word(f.level), f.subject, f.text);
  const auto problems = count(findings, Level::problem), warnings = count(findings, Level::warning);
  return out + fmt::format("{} problem{}, {} warning{}\n", problems, problems == 1 ? "" : "s",
                           warnings, warnings == 1 ? "" : "s");
}

int run(const std::string& side, const ProgramOptions& options, const Look& more) {
  std::optional<Scene> scene;
  Findings findings{scene_file(options.scene, scene)};
  if (scene) add(findings, link(side, options, *scene));
  if (scene && more) add(findings, more(*scene));
  const proto::Scene words = scene ? scene->proto : proto::Scene();
  const bool master = side == "master";
  const RealtimeConfig realtime =
      realtime_config(master ? words.master().realtime() : words.slave().realtime());
  // As degraded_refusal.
  const bool starts = !master || !words.master().has_falcon_usb() || realtime.allow_degraded;
  add(findings, examine(words, realtime, starts ? Level::warning : Level::problem));
  std::fputs(to_text(findings).c_str(), stdout);
  return count(findings, Level::problem) > 0 ? 1 : 0;
}

}  // namespace farhand::doctor
