// Motor torques in the device's counts. How many counts make a newton metre at the arm is a
// parameter to be calibrated: the two public values differ by half. The sign of both is that of
// captured packets, in which a pull towards the base is positive.
//
// The widely used public driver casts each motor's counts to 16 bits without a limit, so that a
// large force turns round. Here all three are scaled together: the direction stays.
#pragma once

#include <cmath>
#include <cstdint>

#include "common/limits.hpp"
#include "master/falcon_usb/packet.hpp"

namespace farhand::falcon_usb {

inline constexpr double kMostCounts = 4095;  // of a motor, either way; more is not stronger

// [1/(N m)], of the torque at the arm in the sense of theta1.
inline constexpr double kGainCharacterised = -6616;  // measured at rest, for the geometry table1
inline constexpr double kGainLibnifalcon = -10000;   // that driver's, for its geometry

// The nearest counts to tau [N m], scaled as a whole where a motor would exceed its limit: each
// motor within half a count of the direction asked for. Zero for a torque that is not finite.
inline AxisWords motor_counts(const Vec3& tau, double counts_per_newton_meter) noexcept {
  const Vec3 wanted = counts_per_newton_meter * tau;
  if (!wanted.allFinite()) return {};
  const Vec3 counts = clamp_scaled(wanted, kMostCounts);
  AxisWords out{};
  for (int i = 0; i < 3; ++i) out[i] = static_cast<std::int16_t>(std::lround(counts[i]));
  return out;
}

// [N m] at the arm.
inline Vec3 torque_of_counts(const AxisWords& counts, double counts_per_newton_meter) noexcept {
  return Vec3(counts[0], counts[1], counts[2]) / counts_per_newton_meter;
}

}  // namespace farhand::falcon_usb
