// Orientation from gyroscope, accelerometer and, where there is one, magnetometer: Mahony's
// complementary filter on quaternions with bias estimate (Mahony, Hamel and Pflimlin 2008, eq. 32
// and 34), its corrections written in the fixed axes M:
//
//   q' = 1/2 q (omega_m - b),   q <- exp(k e_M) q,   b' = -kb R^T e_M,
//   e_M = measured up x up, and the angle about up from the measured to the reference north
//
// Each correction has its constant share k, or the larger one that the uncertainty asks for: so it
// finds its orientation quickly at start and after a gap. Without a magnetometer nothing tells the
// turn about up: it drifts, and yaw_sigma() grows.
#pragma once

#include "common/geometry.hpp"
#include "master/ahrs/angle_uncertainty.hpp"

namespace farhand {

struct AttitudeFilterConfig {
  Vec3 up_M = Vec3::UnitY();
  double tilt_rate = 0.5;    // [1/s] at which tilt is corrected
  double yaw_rate = 0.3;     // [1/s] the same about up, by the magnetometer
  double bias_rate = 0.03;   // [1/s^2]
  double max_bias = 0.087;   // [rad/s] each axis, 5 deg/s
  double off_gravity = 0.6;  // [m/s^2] an acceleration this far off 9.81 counts for nothing
  double off_field = 0.15;   // share by which size or dip of the field may change
  // At rest for rest_time the gyroscope tells its bias.
  double rest_turn = 0.010;  // [rad/s] around its mean of 0.5 s, more is motion
  double rest_bias = 0.03;   // [rad/s] from the bias so far, more is a steady turn
  double rest_time = 1.5;    // [s]
  // What the sensors are taken to be, for the uncertainties.
  double gyro_noise = 1.8e-4;    // [rad/s/sqrt(Hz)]
  double bias_walk = 6e-5;       // [rad/s/sqrt(s)]
  double bias_unknown = 0.0175;  // [rad/s] at start, if it starts in motion
  double bias_at_rest = 5e-4;    // [rad/s] after rest
  double turn_error = 0.006;     // share of a turn, the gyroscope's scale
  double tilt_noise = 0.05;      // [rad] of one measurement
  double yaw_noise = 0.05;       // [rad] the same
  double tilt_floor = 0.006;     // [rad] what no averaging removes: the accelerometer's offset
  double yaw_floor = 0.015;      // [rad] the magnetometer's
};

class AttitudeFilter {
 public:
  explicit AttitudeFilter(const AttitudeFilterConfig& config) noexcept : config_(config) {}

  // The first orientation: upright by the mean specific force and gyroscope of a while, the turn
  // about up being the smallest. at_rest: it did not turn meanwhile, and the gyroscope read its
  // bias. The field there and then, if any, is the reference from now on.
  void start(const Vec3& acceleration_H, const Vec3& gyro_H, bool at_rest,
             const Vec3* magnetic_H) noexcept;

  // dt [s] of turning as the gyroscope says [rad/s].
  void turn(const Vec3& gyro_H, double dt) noexcept;
  // dt [s] of which nothing is known.
  void missed(double dt, double turn_rate) noexcept;
  // Both corrections return the turn that they made, in M axes: what was written in M by the filter
  // before it has to be turned, too.
  //
  // Specific force [m/s^2] without the grip's own acceleration, M axes by this filter; dt [s] since
  // the last. Does little while its size is not that of gravity.
  Quat correct_tilt(const Vec3& gravity_M, double dt) noexcept;
  // Field [T] in M axes by this filter. Does nothing before start() has seen one, nor while size or
  // dip differ from then.
  Quat correct_yaw(const Vec3& field_M, double dt) noexcept;

  const Quat& q_MH() const noexcept { return q_MH_; }
  const Vec3& bias() const noexcept { return bias_; }  // [rad/s], H axes
  bool at_rest() const noexcept { return still_for_ >= config_.rest_time; }
  // Standard deviations [rad], pi at most.
  double tilt_sigma() const noexcept;
  double yaw_sigma() const noexcept;

 private:
  void find_rest(const Vec3& gyro_H, double dt) noexcept;
  Quat correct(const Vec3& error_M, double share, double dt) noexcept;

  AttitudeFilterConfig config_;
  Quat q_MH_ = Quat::Identity();
  Vec3 bias_ = Vec3::Zero();
  Vec3 slow_gyro_ = Vec3::Zero();
  double still_for_ = 0;         // [s]
  Vec3 north_M_ = Vec3::Zero();  // of the field, level; zero without
  double field_size_ = 0, field_dip_ = 0;
  bool yaw_measured_ = false;
  AngleUncertainty tilt_, yaw_;
  double turned_ = 0;  // [rad] about up and not yet corrected
};

}  // namespace farhand
