// Sine and cosine of several angles at once, without libm: the same bits from every compiler and on
// every processor (libm picks its kernel by processor), and in a form compilers turn into SIMD.
#pragma once

#include <array>
#include <bit>
#include <cmath>
#include <cstddef>
#include <cstdint>

namespace farhand {

template <std::size_t N>
struct SinCos {
  std::array<double, N> s{};
  std::array<double, N> c{};
};

// Angles [rad]; within 1e-16 of the true values for |angle| <= 1e6. Beyond that, and for
// non-finite angles, this is std::sin and std::cos.
template <std::size_t N>
SinCos<N> sincos(const double* angle) noexcept {
  // pi/2 in three parts; the first two have 33 bits, so their products with n are exact.
  constexpr double kPart1 = 0x1.921fb544p+0, kPart2 = 0x1.0b4611a6p-34,
                   kPart3 = 0x1.3198a2e037073p-69;
  constexpr double kTwoOverPi = 0x1.45f306dc9c883p-1, kRound = 0x1.8p52;
  SinCos<N> out;
  double largest = 0;
  for (std::size_t i = 0; i < N; ++i) {
    const double x = angle[i];
    largest = std::abs(x) <= largest ? largest : std::abs(x);
    const double shifted = x * kTwoOverPi + kRound;  // the quarter turn n sits in the low bits
    const auto quarter = std::bit_cast<std::uint64_t>(shifted);
    const double n = shifted - kRound;
    const double t = x - n * kPart1, second = n * kPart2, third = n * kPart3;
    const double u = t - second, r = u - third;                  // |r| <= pi/4
    const double tail = ((t - u) - second) + ((u - r) - third);  // what rounding took from r
    const double z = r * r, zz = z * z;
    // Taylor terms up to r^17 and r^16, what is left is below 2e-18.
    const double s_low = (-1.0 / 6 + z * (1.0 / 120)) + zz * (-1.0 / 5040 + z * (1.0 / 362880));
    const double s_high = (-1.0 / 39916800 + z * (1.0 / 6227020800)) +
                          zz * (-1.0 / 1307674368000 + z * (1.0 / 355687428096000));
    const double c_low = (1.0 / 24 + z * (-1.0 / 720)) + zz * (1.0 / 40320 + z * (-1.0 / 3628800));
    const double c_high =
        (1.0 / 479001600 + z * (-1.0 / 87178291200)) + zz * (1.0 / 20922789888000);
    const double half = 0.5 * z, rest = 1 - half;
    const double sine = r + (r * z * (s_low + zz * zz * s_high) + tail * rest);
    const double cosine =
        rest + (((1 - rest) - half) + (zz * (c_low + zz * zz * c_high) - tail * r));
    // Odd quarters swap the two; the signs follow from bit 1 of n and of n + 1.
    const std::uint64_t swap = -(quarter & 1);
    const auto a = std::bit_cast<std::uint64_t>(sine), b = std::bit_cast<std::uint64_t>(cosine);
    const std::uint64_t flip = (a ^ b) & swap;
    out.s[i] = std::bit_cast<double>((a ^ flip) ^ ((quarter & 2) << 62));
    out.c[i] = std::bit_cast<double>((b ^ flip) ^ (((quarter + 1) & 2) << 62));
  }
  if (!(largest <= 1e6)) {
    for (std::size_t i = 0; i < N; ++i)
      out.s[i] = std::sin(angle[i]), out.c[i] = std::cos(angle[i]);
  }
  return out;
}

}  // namespace farhand
