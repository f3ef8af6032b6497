// What an attitude and heading reference system (AHRS) tells at one instant, in its own axes.
#pragma once

#include <cstdint>
#include <optional>

#include "common/geometry.hpp"
#include "common/time.hpp"

namespace farhand {

struct AhrsSample {
  Vec3 gyro = Vec3::Zero();          // [rad/s]
  Vec3 acceleration = Vec3::Zero();  // specific force [m/s^2]: at rest it points up, 9.81
  std::optional<Vec3> magnetic{};    // [T]
  std::optional<Quat> attitude{};    // of the sensor in its own reference (w, x, y, z), unit length
  std::optional<Duration> time{};    // of the device's own clock, from any zero
};

// What a sensor reads made right, axis by axis: scale (reading - offset).
struct SensorFit {
  Vec3 offset = Vec3::Zero();
  Vec3 scale = Vec3::Ones();

  Vec3 operator()(const Vec3& reading) const noexcept {
    return scale.cwiseProduct(reading - offset);
  }
};

// No sensor for a hand reads more: 100 rad/s, 1000 m/s^2, 0.01 T. False for numbers not finite.
inline bool plausible(const AhrsSample& s) noexcept {
  return s.gyro.cwiseAbs().maxCoeff() <= 100 && s.gyro.allFinite() &&
         s.acceleration.cwiseAbs().maxCoeff() <= 1000 && s.acceleration.allFinite() &&
         (!s.magnetic || (s.magnetic->allFinite() && s.magnetic->cwiseAbs().maxCoeff() <= 0.01)) &&
         (!s.attitude || s.attitude->coeffs().allFinite());
}

}  // namespace farhand
