// How long the stress tests run.
#pragma once

#include <cstdint>
#include <cstdlib>

namespace farhand {

// FARHAND_STRESS_TICKS, or what the gate can afford.
inline std::uint64_t stress_ticks(std::uint64_t in_the_gate) {
  const char* asked = std::getenv("FARHAND_STRESS_TICKS");
  return asked != nullptr ? std::strtoull(asked, nullptr, 10) : in_the_gate;
}

}  // namespace farhand
