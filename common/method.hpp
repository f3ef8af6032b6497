// The ways to make up for delay that the two sides can use between them.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>

namespace farhand {

// The numbers are those of the wire and of recordings.
enum class Method : std::uint8_t { direct, damped, wave, smith, mmt };
inline constexpr std::size_t kMethods = 5;

constexpr const char* to_string(Method m) noexcept {
  constexpr std::array<const char*, kMethods> kNames = {"direct", "damped", "wave", "smith", "mmt"};
  return kNames[static_cast<std::size_t>(m)];
}

}  // namespace farhand
