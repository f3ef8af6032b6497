// What one Falcon's own numbers are, from poses and weights that the user knows. Least squares.
#pragma once

#include <span>
#include <vector>

#include "master/falcon.hpp"

namespace farhand::falcon_usb {

// The grip rested at a place whose coordinates are known: along the axes of M, from any origin.
struct KnownPose {
  Vec3 counts = Vec3::Zero();  // of the encoders, mean
  Vec3 p = Vec3::Zero();       // [m]
};

// Gear ratio and angle offset of `geometry`, and that origin, such that forward kinematics of the
// counts give the poses.
struct GeometryFit {
  bool good = false;        // found; else nothing below means anything
  FalconGeometry geometry;  // the one given, with gear_ratio and angle_offset fitted
  Vec3 origin_M = Vec3::Zero();
  double gear_ratio_sd = 0;       // standard deviations by the residuals
  double angle_offset_sd = 0;     // [rad]
  std::vector<double> residuals;  // [m], one per pose
  double rms = 0;                 // [m] of them
};
inline constexpr std::size_t kFewestPoses = 4;
// Not good: fewer poses, counts out of the device's reach, or poses so alike that they do not tell.
GeometryFit fit_geometry(const FalconGeometry& geometry, std::span<const KnownPose> poses);

// The motors held a known mass [kg] at rest, hung on the grip, 0 included.
struct KnownLoad {
  Vec3 p_MH = Vec3::Zero();
  Vec3 motors = Vec3::Zero();  // motor counts, mean
  double mass = 0;
};

struct GainFit {
  bool good = false;
  double counts_per_newton_meter = 0;  // of the torque at the arm; negative in the device's sense
  double gain_sd = 0;
  double grip_mass = 0;           // [kg] that the motors carry without the load
  std::vector<double> residuals;  // [N], one per load: force the fit does not explain
};
// Y of M is up. Not good: masses that do not differ by 20 g, or a place without a map of forces.
GainFit fit_gain(const FalconGeometry& geometry, std::span<const KnownLoad> loads);

}  // namespace farhand::falcon_usb
