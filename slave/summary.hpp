// What the slave's end of a run is told by: how well the robot followed, and what held it back.
#pragma once

#include <array>

#include "common/limit_counts.hpp"
#include "common/mode.hpp"
#include "common/statistics.hpp"
#include "slave/slave.hpp"

namespace farhand {

struct SlaveSummary {
  std::uint64_t ticks = 0;
  std::uint64_t left_out = 0;  // answers that would have told nothing new
  std::array<std::uint64_t, kModes> ticks_in_mode{};
  std::uint64_t coupled_ticks = 0;
  // Tool target against tool, while coupled.
  Rms position_free, position_contact;  // [m]
  Rms rotation_free, rotation_contact;  // [rad]
  double largest_turn = 0;              // [rad] by which the handle was off when coupled again
  Rms force;                            // size of the contact force [N] while touching
  LimitCounts limits;

  void add(const SlaveTick& tick) noexcept;
};

}  // namespace farhand
