// One episode: a plan carried out on both sides, their links and their simulated plants.
#pragma once

#include <string>
#include <vector>

#include "common/statistics.hpp"
#include "tests/loop/checkers.hpp"
#include "tests/sim/plan.hpp"

namespace farhand {

struct EpisodeOptions {
  bool faults = true;
  std::string record;  // file to write, if any
};

struct EpisodeResult {
  std::uint64_t violations = 0;
  std::vector<Violation> first_violations;
  std::vector<std::string> last_events;
  Duration ready_after{};     // since the faults stopped
  Duration oldest_command{};  // that the robot's command moved by
  std::uint64_t engaged = 0;  // ticks of the slave while faults were possible
  std::uint64_t engagements = 0;
  // Of the quiet phase, free and within all limits (tests/sim/tracking.hpp) [m].
  Rms lag, command, tool;
  long limited = 0;  // [ticks] of that phase in which a limit held the tool back

  bool good() const noexcept { return violations == 0; }
};

EpisodeResult run_episode(const Plan& plan, const EpisodeOptions& options);

}  // namespace farhand
