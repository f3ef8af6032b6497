// A Falcon's grip with an AHRS on it: a smooth motion of place and orientation, encoders with their
// step through the forward kinematics, and the AHRS' bytes through the parser.
#pragma once

#include <functional>
#include <numbers>
#include <vector>

#include "common/pid.hpp"
#include "master/ahrs/grip_motion.hpp"
#include "master/ahrs/sim_ahrs.hpp"
#include "master/falcon.hpp"

namespace farhand::support {

constexpr double kDegrees = 180 / std::numbers::pi;

// Rest for rest seconds, then sines that come up within one; about the workspace's middle.
struct GripCourse {
  double rest = 2;
  double turns = 1;  // of the orientation
  double moves = 1;  // of the place

  static double tone(double t, double hz, double phase = 0) {
    return std::sin(2 * std::numbers::pi * hz * t + phase);
  }
  double swell(double t) const {
    const double s = std::clamp(t - rest, 0.0, 1.0);
    return s * s * s * (10 + s * (6 * s - 15));
  }
  // Slow strokes, faster ones, and a tremor of 0.1 mm.
  Vec3 p(double t) const {
    const Vec3 stroke(0.020 * tone(t, 0.5), 0.016 * tone(t, 0.7, 1), 0.018 * tone(t, 0.4, 2));
    const Vec3 quick(0.005 * tone(t, 1.7), 0.004 * tone(t, 2.3, 2), 0.004 * tone(t, 1.9, 1));
    const Vec3 tremor(1e-4 * tone(t, 8), 1e-4 * tone(t, 9, 1), 1e-4 * tone(t, 8.5, 2));
    return Vec3(0, 0, 0.125) + moves * swell(t) * (stroke + quick + tremor);
  }
  Mat3 R(double t) const {
    const Vec3 slow(0.4 * tone(t, 0.31), 0.35 * tone(t, 0.23, 1), 0.35 * tone(t, 0.37, 2));
    const Vec3 quick(0.08 * tone(t, 1.5), 0.08 * tone(t, 1.3, 1), 0.08 * tone(t, 1.1, 2));
    return rotation(turns * swell(t) * (slow + quick));
  }
  Vec3 v(double t) const { return (p(t + kStep) - p(t - kStep)) / (2 * kStep); }
  GripTruth truth(double t) const {
    GripTruth g{.R_MH = R(t), .omega_H = omega_H(t)};
    g.alpha_H = (omega_H(t + kStep) - omega_H(t - kStep)) / (2 * kStep);
    g.a_MH = (v(t + kStep) - v(t - kStep)) / (2 * kStep);
    return g;
  }

 private:
  static constexpr double kStep = 1e-4;
  Vec3 omega_H(double t) const {
    return R(t).transpose() * rotation_vector(R(t + kStep) * R(t - kStep).transpose()) /
           (2 * kStep);
  }
};

// The grip's place as encoders of this geometry tell it.
inline Vec3 encoded(const FalconGeometry& made, const FalconGeometry& believed, const Vec3& p_MH) {
  const double made_step = theta1_quantum(made), believed_step = theta1_quantum(believed);
  Vec3 theta = motor_angles(made, p_MH).theta1;
  for (double& x : theta)
    x = made.angle_offset + made_step * std::round((x - made.angle_offset) / made_step);
  theta =
      ((theta.array() - made.angle_offset) * (believed_step / made_step) + believed.angle_offset)
          .matrix();
  return forward(believed, theta, p_MH).p_MH;
}

struct GripRig {
  static constexpr double kTs = 0.001;

  GripCourse course{};
  SimAhrsConfig ahrs{};
  GripMotionConfig motion{};
  FalconGeometry believed = kFalconTable1;
  std::uint64_t seed = 1;

  struct Tick {
    double t = 0;
    Vec3 p_encoder = Vec3::Zero();
    const GripMotionEstimate* estimate = nullptr;
    const AhrsParser* parser = nullptr;
  };
  // Calls see() after every tick; silent(t): nothing of what the AHRS sends arrives.
  void run(
      double duration, const std::function<void(const Tick&)>& see,
      const std::function<bool(double)>& silent = [](double) { return false; }) const {
    SimAhrs source(ahrs, seed);
    AhrsParser parser(ahrs.format);
    GripMotion fusion(motion);
    for (int k = 0; k * kTs < duration; ++k) {
      const double t = k * kTs;
      const TimePoint now{std::chrono::seconds(100) + std::chrono::milliseconds(k)};
      source.advance(now, course.truth(t));
      const auto bytes = source.read(now);
      if (!silent(t)) parser.push(bytes);
      while (const auto sample = parser.next()) fusion.take(*sample, now);
      const Vec3 p = encoded(kFalconTable1, believed, course.p(t));
      const GripMotionEstimate& estimate = fusion.step(now, &p);
      see({t, p, &estimate, &parser});
    }
  }
};

// How far an orientation is off [rad], in M: tilt, and the turn about up.
struct OrientationError {
  double tilt = 0, yaw = 0, whole = 0;
};
inline OrientationError orientation_error(const Mat3& R, const Mat3& truth) {
  const Vec3 r = rotation_vector(R * truth.transpose());
  return {std::hypot(r.x(), r.z()), r.y(), r.norm()};
}

}  // namespace farhand::support
