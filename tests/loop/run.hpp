// One run of a scene in virtual time, judged: what farhand-loopback prints and what the scene tests
// assert.
#pragma once

#include <string>
#include <vector>

#include "common/recording_file.hpp"
#include "common/statistics.hpp"
#include "master/summary.hpp"
#include "slave/summary.hpp"
#include "tests/loop/checkers.hpp"
#include "tests/loop/loopback.hpp"

namespace farhand {

// How a set point or a push was mastered by position control: from its begin to the last instant,
// before the next, at which any axis of the grip was off target by more than 1.5 mm.
struct Settling {
  double at_s = 0;
  double settled_after_s = 0;
  double peak_m = 0;
};

// Each axis of a wrench on its own: force x y z [N], torque x y z [N m].
struct WrenchRms {
  std::array<Rms, 6> axes;
  void add(const Wrench& F) noexcept {
    for (int i = 0; i < 3; ++i) axes[i].add(F.force[i]), axes[i + 3].add(F.torque[i]);
  }
};

struct RunResult {
  double simulated_s = 0;
  double wall_s = 0;
  MasterSummary master;
  SlaveSummary slave;
  // The true tool against where the true handle, at the same instant, asks it to be: servo and
  // network together. In a replay the measured handle stands for the true one.
  Rms handle_to_robot_free, handle_to_robot_contact;  // [m]
  // What the user truly feels against what the environment gives, in handle axes, while coupled.
  // Nothing in a replay.
  WrenchRms user_to_environment_free, user_to_environment_contact;
  std::vector<Settling> settling;
  double peak_penetration = 0;  // [m]
  LinkCounters master_link, slave_link;
  LinkQuality quality;
  std::uint64_t violations = 0;
  std::vector<Violation> first_violations;
  std::uint64_t digest =
      0;  // of every joint angle and torque on both sides: same bits, same digest

  bool good() const noexcept { return violations == 0; }
};

// Records both sides into `file` if there is one.
RunResult run_scene(const Scene& scene, const LoopbackOptions& options,
                    RecordingFile* file = nullptr);

std::string to_text(const RunResult& result);
std::string to_json(const RunResult& result);

}  // namespace farhand
