// Two doubles worked on at once, as wide as every x86-64 and ARM64 processor goes: operators act
// on each, comparisons give a mask of ones or zeros, and every compiler rounds each like a double.
#pragma once

#include <bit>
#include <cmath>
#include <cstddef>
#include <cstdint>

namespace farhand {

using Lanes = double __attribute__((vector_size(16)));
using LaneBits = std::uint64_t __attribute__((vector_size(16)));
inline constexpr std::size_t kLanes = 2;
inline constexpr LaneBits kSignBit{std::uint64_t{1} << 63, std::uint64_t{1} << 63};

inline Lanes lanes(double x) noexcept {
  return Lanes{x, x};
}
inline LaneBits bits(Lanes v) noexcept {
  return std::bit_cast<LaneBits>(v);
}
inline Lanes from_bits(LaneBits b) noexcept {
  return std::bit_cast<Lanes>(b);
}
// Each lane of a where the mask is set, of b elsewhere.
inline Lanes select(LaneBits mask, Lanes a, Lanes b) noexcept {
  return from_bits((bits(a) & mask) | (bits(b) & ~mask));
}
inline Lanes magnitude(Lanes v) noexcept {
  return from_bits(bits(v) & ~kSignBit);
}
inline Lanes sqrt(Lanes v) noexcept {
  return Lanes{std::sqrt(v[0]), std::sqrt(v[1])};
}
inline LaneBits less(Lanes a, Lanes b) noexcept {
  return (LaneBits)(a < b);
}

// The i-th pair of an array of n; past its end the last element again.
inline Lanes load(const double* from, std::size_t i, std::size_t n) noexcept {
  return Lanes{from[i], from[i + 1 < n ? i + 1 : i]};
}
inline void store(double* to, std::size_t i, std::size_t n, Lanes v) noexcept {
  to[i] = v[0];
  if (i + 1 < n) to[i + 1] = v[1];
}

}  // namespace farhand
