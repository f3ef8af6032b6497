// Unsigned numbers as little-endian bytes on any machine.
#pragma once

#include <bit>
#include <concepts>
#include <cstddef>
#include <cstring>

namespace farhand {

template <std::unsigned_integral T>
T load_little_endian(const std::byte* from) noexcept {
  T x = 0;
  if constexpr (std::endian::native == std::endian::little) {
    std::memcpy(&x, from, sizeof(T));  // compilers at -O2 do not see one load in the loop below
  } else {
    for (std::size_t i = sizeof(T); i-- > 0;)
      x = static_cast<T>((x << 8) | static_cast<T>(from[i]));
  }
  return x;
}

template <std::unsigned_integral T>
void store_little_endian(T x, std::byte* to) noexcept {
  for (std::size_t i = 0; i < sizeof(T); ++i) to[i] = static_cast<std::byte>(x >> (8 * i));
}

}  // namespace farhand
