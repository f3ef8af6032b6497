// Rows that both sides' tables share.
#pragma once

#include <array>
#include <cstdint>
#include <string>

#include "common/limit_counts.hpp"
#include "common/mode.hpp"

namespace farhand {

std::string mode_row(std::uint64_t ticks, const std::array<std::uint64_t, kModes>& ticks_in_mode);
std::string limit_row(const LimitCounts& limits);
std::string lost_records_row(std::uint64_t lost);  // empty when none is lost

}  // namespace farhand
