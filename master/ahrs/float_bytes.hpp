// Little-endian floats and vectors of them, written and read one after the other.
#pragma once

#include <bit>

#include "common/bytes.hpp"
#include "common/geometry.hpp"

namespace farhand {

inline float load_float(const std::byte* from) noexcept {
  return std::bit_cast<float>(load_little_endian<std::uint32_t>(from));
}
inline Vec3 load_vec3(const std::byte* from) noexcept {
  return {load_float(from), load_float(from + 4), load_float(from + 8)};
}
inline std::byte* store_float(double x, std::byte* to) noexcept {
  store_little_endian(std::bit_cast<std::uint32_t>(static_cast<float>(x)), to);
  return to + 4;
}
inline std::byte* store_vec3(const Vec3& v, std::byte* to) noexcept {
  for (const double x : v) to = store_float(x, to);
  return to;
}

}  // namespace farhand
