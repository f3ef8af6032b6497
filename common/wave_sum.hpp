// What the wave method sends of its waves (common/wave.hpp), in either direction.
#pragma once

#include "common/geometry.hpp"

namespace farhand {

// Since the session began.
struct WaveSum {
  Vec3 U = Vec3::Zero();  // integral of the wave [m sqrt(N s/m)]
  double E = 0;           // of half its square [J]
};
inline WaveSum operator+(const WaveSum& a, const WaveSum& b) noexcept {
  return {a.U + b.U, a.E + b.E};
}
inline WaveSum operator-(const WaveSum& a, const WaveSum& b) noexcept {
  return {a.U - b.U, a.E - b.E};
}
inline WaveSum operator*(double s, const WaveSum& a) noexcept {
  return {s * a.U, s * a.E};
}
inline WaveSum after(const WaveSum& sum, const Vec3& wave, double Ts) noexcept {
  return {sum.U + Ts * wave, sum.E + Ts / 2 * wave.squaredNorm()};
}

}  // namespace farhand
