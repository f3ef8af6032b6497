// farhand-sim: seeded episodes of faults on both sides under virtual time. Exit status 0 if nothing
// was violated, 1 after an error or a violation, 2 for arguments that make no sense.
#include <spdlog/fmt/fmt.h>

#include <algorithm>
#include <atomic>
#include <cstdio>
#include <fstream>
#include <map>
#include <mutex>
#include <sstream>
#include <thread>

#include "common/arguments.hpp"
#include "common/program.hpp"
#include "tests/sim/episode.hpp"

namespace farhand {
namespace {

struct Options {
  std::string seeds = "1:20", record;
  std::optional<std::uint64_t> seed;
  double seconds = 30;
  bool fault_free = false;
};

struct Run {
  std::uint64_t seed = 0;
  double seconds = 0;
};

// Of each line of the file: a seed, the seconds of its episode, and after # what was wrong.
std::vector<Run> failed_before() {
  std::vector<Run> out;
  std::ifstream file(FARHAND_SOURCE_DIR "/tests/sim/failed_seeds.txt");
  for (std::string line; std::getline(file, line);) {
    Run run;
    if (std::istringstream(line) >> run.seed >> run.seconds) out.push_back(run);
  }
  return out;
}

std::vector<Run> runs_of(const Options& o) {
  if (o.seed) return {{*o.seed, o.seconds}};
  std::uint64_t from = 0, to = 0;
  char colon = 0;
  if (!(std::istringstream(o.seeds) >> from >> colon >> to) || colon != ':' || to < from)
    throw std::runtime_error("--seeds " + o.seeds + ": not FROM:TO");
  std::vector<Run> out = failed_before();
  for (; from <= to; ++from) out.push_back({from, o.seconds});
  return out;
}

// What all episodes together came to.
struct Totals {
  std::uint64_t episodes = 0, failed = 0, engagements = 0, engaged = 0, tracked = 0, limited = 0;
  Duration latest_ready{}, oldest_command{};
  struct Peaks {
    double lag = 0, command = 0, tool = 0;  // [m]
  };
  std::map<std::string, Peaks> peaks;  // by scene and method

  void add(const Plan& plan, const EpisodeResult& r) {
    ++episodes;
    failed += !r.good();
    engagements += r.engagements, engaged += r.engaged;
    tracked += r.lag.count > 0;
    limited += r.lag.count == 0 && r.limited > 0;
    latest_ready = std::max(latest_ready, r.ready_after);
    oldest_command = std::max(oldest_command, r.oldest_command);
    Peaks& p = peaks[plan.method.empty() ? plan.scene : plan.scene + " " + plan.method];
    p.lag = std::max(p.lag, r.lag.peak);
    p.command = std::max(p.command, r.command.peak);
    p.tool = std::max(p.tool, r.tool.peak);
  }
  std::string text() const {
    std::string out = fmt::format(
        "{} episodes, {} failed; engaged {} times for {:.0f} s among faults; READY at most {:.2f} "
        "s "
        "after them; in {} the tool was seen to follow freely again, in {} a limit kept it from "
        "that; oldest command acted upon {:.0f} ms\n",
        episodes, failed, engagements, 1e-3 * static_cast<double>(engaged), seconds(latest_ready),
        tracked, limited, 1e3 * seconds(oldest_command));
    for (const auto& [scene, p] : peaks)
      out += fmt::format(
          "  {:<26} tool at most {:6.3f} mm behind the handle, {:.3f} mm off where its servo "
          "drives "
          "it; command {:.3g} mm off what is asked for\n",
          scene, p.lag * 1e3, p.tool * 1e3, p.command * 1e3);
    return out;
  }
};

std::string failure(const Plan& plan, const EpisodeResult& r) {
  std::string out = fmt::format("FAILED {}", to_string(plan));
  for (const Violation& v : r.first_violations)
    out += fmt::format("  at {:.4f} s: {}\n", v.at_s, v.what);
  out += fmt::format("  {} violations; last events\n", r.violations);
  for (const std::string& e : r.last_events) out += "    " + e + "\n";
  return out;
}

class Runner {
 public:
  explicit Runner(const Options& options) : options_(options), runs_(runs_of(options)) {}

  int run() {
    std::vector<std::thread> others;
    for (unsigned i = 1; i < std::thread::hardware_concurrency(); ++i)
      others.emplace_back([this] { work(); });
    work();
    for (std::thread& t : others) t.join();
    std::fputs(totals_.text().c_str(), stdout);
    return totals_.failed == 0 ? 0 : 1;
  }

 private:
  void work() {
    for (std::size_t i = next_++; i < runs_.size(); i = next_++) one(runs_[i]);
  }
  void one(const Run& run) {
    const Plan plan = draw_plan(run.seed, from_seconds(run.seconds));
    EpisodeOptions o{.faults = !options_.fault_free, .record = {}};
    const EpisodeResult r = run_episode(plan, o);
    const bool verbose = options_.seed.has_value();
    if (!options_.record.empty() && (verbose || !r.good())) {
      o.record = fmt::format("{}/seed_{}.mcap", options_.record, run.seed);
      run_episode(plan, o);
    }
    const std::lock_guard lock(mutex_);
    totals_.add(plan, r);
    if (!r.good()) std::fputs(failure(plan, r).c_str(), stdout);
    if (r.good() && verbose) std::fputs(to_string(plan).c_str(), stdout);
    std::fflush(stdout);
  }

  Options options_;
  std::vector<Run> runs_;
  std::atomic<std::size_t> next_ = 0;
  std::mutex mutex_;
  Totals totals_;
};

}  // namespace
}  // namespace farhand

int main(int argc, char** argv) {
  using namespace farhand;
  Arguments arguments("seeded faults on both sides of a teleoperation, in virtual time",
                      "farhand-sim");
  Options options;
  std::optional<std::string> length;
  arguments.option("--seeds", options.seeds, "FROM:TO; those that failed before run first");
  arguments.option("--seed", options.seed, "this one alone, and what it consists of");
  arguments.duration(options.seconds, "simulated seconds of each episode, 15 or more");
  arguments.option("--record", options.record, "folder for MCAP recordings of what failed");
  arguments.flag("--fault-free", options.fault_free, "the same episodes without their faults");
  const auto missing = [&] { return options.seconds >= 15 ? "" : "--duration of 15 or more"; };
  if (const auto status = arguments.parse(argc, argv, missing)) return *status;
  return run_guarded("farhand-sim", [&] { return Runner(options).run(); });
}
