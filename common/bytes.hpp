// Unsigned numbers as little-endian bytes on any machine.
#pragma once

#include <concepts>
#include <cstddef>

namespace farhand {

template <std::unsigned_integral T>
constexpr T load_little_endian(const std::byte* from) noexcept {
  T x = 0;
  for (std::size_t i = 0; i < sizeof(T); ++i)
    x = static_cast<T>(x | static_cast<T>(static_cast<T>(from[i]) << (8 * i)));
  return x;
}

template <std::unsigned_integral T>
constexpr void store_little_endian(T x, std::byte* to) noexcept {
  for (std::size_t i = 0; i < sizeof(T); ++i) to[i] = static_cast<std::byte>(x >> (8 * i));
}

}  // namespace farhand
