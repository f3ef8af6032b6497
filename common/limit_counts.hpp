// How many ticks each limit acted in; none of them is a fault, all of them are worth knowing.
#pragma once

#include <array>
#include <cstdint>

#include "common/limits.hpp"

namespace farhand {

struct LimitCounts {
  std::array<std::uint64_t, kLimitCount> ticks{};
  void add(LimitSet set) noexcept {
    for (int bit = 0; bit < kLimitCount; ++bit) ticks[bit] += (set >> bit) & 1u;
  }
};

}  // namespace farhand
