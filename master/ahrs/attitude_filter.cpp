#include "master/ahrs/attitude_filter.hpp"

namespace farhand {
namespace {

constexpr double kSlow = 0.5;        // [s] of the gyroscope's mean at rest
constexpr double kBiasTime = 1;      // [s] in which the bias follows it there
constexpr double kFirstTilt = 0.01;  // [rad]

// exp of the rotation vector, for turns up to a few radians.
Quat turned_by(const Vec3& r) noexcept {
  const double angle = r.norm();
  const double s = angle < 1e-6 ? 0.5 : std::sin(angle / 2) / angle;
  return {std::cos(angle / 2), s * r.x(), s * r.y(), s * r.z()};
}

Vec3 level(const Vec3& v, const Vec3& up) noexcept {
  return v - up.dot(v) * up;
}

Vec3 bounded(const Vec3& v, double most) noexcept {
  return v.cwiseMax(-most).cwiseMin(most);
}

double dip(const Vec3& field, const Vec3& up) noexcept {
  return std::atan2(up.dot(field), level(field, up).norm());
}

}  // namespace

void AttitudeFilter::start(const Vec3& acceleration_H, const Vec3& gyro_H, bool at_rest,
                           const Vec3* magnetic_H) noexcept {
  q_MH_ = Quat::FromTwoVectors(acceleration_H, config_.up_M);
  bias_ = at_rest ? bounded(gyro_H, config_.max_bias) : Vec3(Vec3::Zero());
  slow_gyro_ = bias_;
  still_for_ = 0;
  turned_ = 0;
  const double rate = at_rest ? config_.bias_at_rest : config_.bias_unknown;
  tilt_ = {kFirstTilt, rate};
  yaw_ = {0, rate};
  north_M_.setZero();
  yaw_measured_ = magnetic_H != nullptr && magnetic_H->norm() > 0;
  if (!yaw_measured_) return;
  const Vec3 field_M = q_MH_ * *magnetic_H;
  field_size_ = field_M.norm();
  field_dip_ = dip(field_M, config_.up_M);
  north_M_ = level(field_M, config_.up_M);
}

void AttitudeFilter::turn(const Vec3& gyro_H, double dt) noexcept {
  find_rest(gyro_H, dt);
  const Vec3 turn_H = dt * (gyro_H - bias_);
  turned_ += config_.up_M.dot(q_MH_ * turn_H);
  q_MH_ = (q_MH_ * turned_by(turn_H)).normalized();
  tilt_.predict(dt, config_.gyro_noise, config_.bias_walk);
  yaw_.predict(dt, config_.gyro_noise, config_.bias_walk);
}

void AttitudeFilter::missed(double dt, double turn_rate) noexcept {
  still_for_ = 0;
  tilt_.unknown(dt, turn_rate);
  yaw_.unknown(dt, turn_rate);
}

void AttitudeFilter::find_rest(const Vec3& gyro_H, double dt) noexcept {
  slow_gyro_ += std::min(dt / kSlow, 1.0) * (gyro_H - slow_gyro_);
  const bool still = (gyro_H - slow_gyro_).cwiseAbs().maxCoeff() < config_.rest_turn &&
                     (slow_gyro_ - bias_).cwiseAbs().maxCoeff() < config_.rest_bias;
  still_for_ = still ? still_for_ + dt : 0;
  if (!at_rest()) return;
  bias_ += std::min(dt / kBiasTime, 1.0) * (slow_gyro_ - bias_);
  tilt_.know_rate(config_.bias_at_rest);
  yaw_.know_rate(config_.bias_at_rest);
}

Quat AttitudeFilter::correct_tilt(const Vec3& gravity_M, double dt) noexcept {
  const double size = gravity_M.norm();
  const double trust = 1 - std::abs(size - kGravity) / config_.off_gravity;
  if (!(trust > 0)) return Quat::Identity();
  const double sigma = config_.tilt_noise / std::sqrt(trust);
  const double share = std::max(trust * config_.tilt_rate * dt, tilt_.share(sigma));
  tilt_.measured(sigma);
  return correct(gravity_M.cross(config_.up_M) / size, share, trust * dt);
}

Quat AttitudeFilter::correct_yaw(const Vec3& field_M, double dt) noexcept {
  const Vec3& up = config_.up_M;
  if (!yaw_measured_) return Quat::Identity();
  const bool disturbed = !(std::abs(field_M.norm() / field_size_ - 1) < config_.off_field) ||
                         !(std::abs(dip(field_M, up) - field_dip_) < config_.off_field);
  if (disturbed) return Quat::Identity();
  const Vec3 north = level(field_M, up);
  const double angle = std::atan2(up.dot(north.cross(north_M_)), north.dot(north_M_));
  const double share = std::max(config_.yaw_rate * dt, yaw_.share(config_.yaw_noise));
  turned_ *= 1 - std::min(share, 1.0);
  yaw_.measured(config_.yaw_noise);
  return correct(angle * up, share, dt);
}

Quat AttitudeFilter::correct(const Vec3& error_M, double share, double dt) noexcept {
  bias_ -= config_.bias_rate * dt * (q_MH_.conjugate() * error_M);
  bias_ = bounded(bias_, config_.max_bias);
  const Quat turn = turned_by(std::min(share, 1.0) * error_M);
  q_MH_ = (turn * q_MH_).normalized();
  return turn;
}

double AttitudeFilter::tilt_sigma() const noexcept {
  return std::min(std::hypot(tilt_.sigma(), config_.tilt_floor), std::numbers::pi);
}

double AttitudeFilter::yaw_sigma() const noexcept {
  const double floor = yaw_measured_ ? config_.yaw_floor : 0;
  return std::min(std::hypot(yaw_.sigma(), floor, config_.turn_error * turned_), std::numbers::pi);
}

}  // namespace farhand
