// What can be said of a serial line without opening it: some devices restart when it is opened.
#pragma once

#include <algorithm>
#include <array>
#include <cstdint>
#include <string>

namespace farhand {

inline constexpr std::array<std::uint64_t, 8> kLineRates{9600,   19200,  38400,  57600,
                                                         115200, 230400, 460800, 921600};
inline constexpr const char* kLineRatesListed =
    "9600, 19200, 38400, 57600, 115200, 230400, 460800 or 921600";

constexpr bool line_runs_at(std::uint64_t baud) noexcept {
  return std::find(kLineRates.begin(), kLineRates.end(), baud) != kLineRates.end();
}

// "cannot be read (why); what to do about it", for an errno that opening the path gave or would.
std::string unreadable_line(const std::string& path, int error);

// The same by asking the system, with the path in front; empty if this process may read it.
std::string line_fault(const std::string& path);

}  // namespace farhand
