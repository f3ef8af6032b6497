// What the master's end of a run is told by: what the hand felt against what the robot touched, and
// what held it back.
#pragma once

#include <array>

#include "common/limit_counts.hpp"
#include "common/mode.hpp"
#include "common/statistics.hpp"
#include "master/master.hpp"

namespace farhand {

struct MasterSummary {
  std::uint64_t ticks = 0;
  std::array<std::uint64_t, kModes> ticks_in_mode{};
  // User's force against the environment's, where the handle senses it, while engaged [N].
  Rms force_free, force_contact;
  Rms force_felt;                     // size of the force commanded on the hand [N]
  Rms position_error;                 // of position control [m]
  std::uint64_t turn_ticks = 0;       // in which the handle was to be turned,
  double largest_turn = 0;            // [rad] by at most this
  std::uint64_t ahrs_lost_ticks = 0;  // the handle's orientation stood still
  double last_outside_s =
      0;  // last time since the first tick at which any axis was off target by more than 1.5 mm
  double peak_control_force = 0;  // [N]
  Duration worst_age{};           // of the wrench used while engaged
  LimitCounts limits;

  void add(const MasterTick& tick) noexcept;

 private:
  void add_position_control(const MasterTick& tick) noexcept;
  TimePoint start_{};
};

}  // namespace farhand
