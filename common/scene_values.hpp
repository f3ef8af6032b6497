// Values as a scene's fields hold them, in the units the code uses.
#pragma once

#include <numbers>

#include "common/geometry.hpp"
#include "common/time.hpp"

namespace farhand {

constexpr double radians(double degrees) noexcept {
  return degrees * (std::numbers::pi / 180);
}

constexpr Duration milliseconds(double ms) noexcept {
  return from_seconds(ms * 1e-3);
}

// A repeated field of three numbers; zero when it is left out.
template <typename RepeatedField>
Vec3 vec3(const RepeatedField& v) {
  return v.size() == 3 ? Vec3(v.Get(0), v.Get(1), v.Get(2)) : Vec3::Zero();
}

}  // namespace farhand
