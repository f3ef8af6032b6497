// Arctangents of several points at once, without libm: the same bits from every compiler, two at a
// time.
#pragma once

#include <array>
#include <cstddef>
#include <numbers>

#include "common/lanes.hpp"

namespace farhand {

// Angle of the direction (x, y) in (-pi, pi], within 1.6 units in the last place; 0 for (0, 0),
// whatever the signs of the zeros; NaN for NaN. Coordinates at most 1e300 in size.
inline Lanes atan2(Lanes y, Lanes x) noexcept {
  constexpr double kPi = std::numbers::pi, kPiLow = 0x1.1a62633145c07p-53;
  // The direction mirrored into the first octant: 0 <= a <= b.
  const Lanes ax = magnitude(x), ay = magnitude(y);
  const LaneBits steep = less(ax, ay), left = less(x, lanes(0));
  const Lanes a = select(steep, ax, ay), b = select(steep, ay, ax);
  // Where tan > 1/3 it is turned back by atan(1/2), ahead of the one division and without rounding
  // the numerator: tan(angle - atan 1/2) = (a - b/2) / (b + a/2). Then |t| <= 1/3.
  constexpr double kAtanHalf = 0x1.dac670561bb4fp-2, kAtanHalfLow = 0x1.a2b7f222f65e2p-56;
  const LaneBits high = less(b * 0x1.55p-2, a);
  const Lanes divisor = b + from_bits(bits(0.5 * a) & high);
  const Lanes t =
      (a - from_bits(bits(0.5 * b) & high)) / select((LaneBits)(divisor == 0), lanes(1), divisor);
  // Minimax: what is left is below 1e-18.
  const Lanes z = t * t, zz = z * z;
  const Lanes p = (z * 0x1.99999999995eap-3 - 0x1.5555555555555p-2) +
                  zz * (z * 0x1.c71c71890f66fp-4 - 0x1.249249244dacdp-3);
  const Lanes q = (z * 0x1.3b11cb76de8e6p-4 - 0x1.745d08fbafefap-4) +
                  zz * (z * 0x1.dddd37d1c319cp-5 - 0x1.10e98f71d8431p-4);
  const Lanes r = z * 0x1.deefe3ad6f196p-6 - 0x1.8ee5cb332eef0p-5;
  const Lanes bend = t * z * (p + (zz * zz) * (q + (zz * zz) * r));
  // Back to the half plane: base + or - (atan(1/2) + t + bend), small terms first.
  const LaneBits minus = (steep ^ left) & kSignBit;
  const Lanes base = select(steep, lanes(kPi / 2), from_bits(bits(lanes(kPi)) & left));
  const Lanes base_low = select(steep, lanes(kPiLow / 2), from_bits(bits(lanes(kPiLow)) & left));
  const Lanes back = from_bits((bits(lanes(kAtanHalf)) & high) ^ minus);
  const Lanes back_low = from_bits((bits(lanes(kAtanHalfLow)) & high) ^ minus);
  const Lanes sum = base + back, lost = (base - sum) + back;
  const Lanes rest = (base_low + back_low + lost) + from_bits(bits(bend) ^ minus);
  const Lanes angle = sum + (from_bits(bits(t) ^ minus) + rest);
  // Rounded to pi the angle keeps its sign: -pi is not an answer.
  return from_bits(bits(angle) ^ (less(y, lanes(0)) & less(angle, lanes(kPi)) & kSignBit));
}

template <std::size_t N>
void atan2(const double* y, const double* x, double* angle) noexcept {
  for (std::size_t i = 0; i < N; i += kLanes)
    store(angle, i, N, atan2(load(y, i, N), load(x, i, N)));
}

}  // namespace farhand
