// Sine and cosine of several angles at once, without libm: the same bits from every compiler and on
// every processor (libm picks its kernel by processor), two at a time.
#pragma once

#include <array>
#include <cmath>
#include <cstddef>

#include "common/lanes.hpp"

namespace farhand {

template <std::size_t N>
struct SinCos {
  std::array<double, N> s;
  std::array<double, N> c;
};

struct SinCosLanes {
  Lanes s, c;
};
// For |angle| <= 1e6.
inline SinCosLanes sincos(Lanes angle) noexcept {
  // pi/2 in three parts; the first two have 33 bits, so their products with n are exact.
  constexpr double kPart1 = 0x1.921fb544p+0, kPart2 = 0x1.0b4611a6p-34,
                   kPart3 = 0x1.3198a2e037073p-69;
  constexpr double kTwoOverPi = 0x1.45f306dc9c883p-1, kRound = 0x1.8p52;
  const Lanes shifted = angle * kTwoOverPi + kRound;  // the quarter turn n sits in the low bits
  const LaneBits quarter = bits(shifted);
  const Lanes n = shifted - kRound;
  const Lanes t = angle - n * kPart1, second = n * kPart2, third = n * kPart3;
  const Lanes u = t - second, r = u - third;                  // |r| <= pi/4
  const Lanes tail = ((t - u) - second) + ((u - r) - third);  // what rounding took from r
  // Minimax: what is left is below 5e-18.
  const Lanes z = r * r, zz = z * z;
  const Lanes s_low = (z * 0x1.1111111111110p-7 - 0x1.5555555555555p-3) +
                      zz * (z * 0x1.71de3a54607a5p-19 - 0x1.a01a01a019937p-13);
  const Lanes s_high =
      (z * 0x1.61217ee5cca1bp-33 - 0x1.ae64541295cdfp-26) - zz * 0x1.ab17bdcbd3414p-41;
  const Lanes c_low = (0x1.5555555555555p-5 - z * 0x1.6c16c16c16967p-10) +
                      zz * (0x1.a01a019f4e9b4p-16 - z * 0x1.27e4fa17bf139p-22);
  const Lanes c_high = 0x1.1eeb68cd22f56p-29 - z * 0x1.907d8f29fe831p-37;
  const Lanes half = 0.5 * z, rest = 1 - half;
  const Lanes sine = r + (r * z * (s_low + zz * zz * s_high) + tail * rest);
  const Lanes cosine = rest + (((1 - rest) - half) + (zz * (c_low + zz * zz * c_high) - tail * r));
  // Odd quarters swap the two; the signs follow from bit 1 of n and of n + 1.
  const LaneBits flip = (bits(sine) ^ bits(cosine)) & -(quarter & 1);
  return {from_bits((bits(sine) ^ flip) ^ ((quarter & 2) << 62)),
          from_bits((bits(cosine) ^ flip) ^ (((quarter + 1) & 2) << 62))};
}

// Angles [rad]; within 1e-16 of the true values for |angle| <= 1e6. Beyond that, and for
// non-finite angles, this is std::sin and std::cos.
template <std::size_t N>
SinCos<N> sincos(const double* angle) noexcept {
  SinCos<N> out;
  LaneBits small = ~LaneBits{};
  for (std::size_t i = 0; i < N; i += kLanes) {
    const Lanes x = load(angle, i, N);
    small &= less(magnitude(x), lanes(1e6));
    const SinCosLanes y = sincos(x);
    store(out.s.data(), i, N, y.s);
    store(out.c.data(), i, N, y.c);
  }
  if ((small[0] & small[1]) == 0) {
    for (std::size_t i = 0; i < N; ++i)
      out.s[i] = std::sin(angle[i]), out.c[i] = std::cos(angle[i]);
  }
  return out;
}

}  // namespace farhand
