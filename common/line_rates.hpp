// The rates [baud] of a serial line.
#pragma once

#include <algorithm>
#include <array>
#include <cstdint>

namespace farhand {

inline constexpr std::array<std::uint64_t, 8> kLineRates{9600,   19200,  38400,  57600,
                                                         115200, 230400, 460800, 921600};
inline constexpr const char* kLineRatesListed =
    "9600, 19200, 38400, 57600, 115200, 230400, 460800 or 921600";

constexpr bool line_runs_at(std::uint64_t baud) noexcept {
  return std::find(kLineRates.begin(), kLineRates.end(), baud) != kLineRates.end();
}

}  // namespace farhand
