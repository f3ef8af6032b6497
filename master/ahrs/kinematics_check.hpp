// Encoders against accelerometer: two measurements of the grip's acceleration that share nothing.
// Wrong lengths, gears or zeros of the kinematics make the one larger than the other.
#pragma once

#include "common/geometry.hpp"

namespace farhand {

class KinematicsCheck {
 public:
  // Acceleration by the encoders and what the AHRS says beyond it, M axes [m/s^2].
  void add(const Vec3& a_encoder_M, const Vec3& error_M) noexcept {
    product_ += a_encoder_M.cwiseProduct(error_M);
    square_ += a_encoder_M.cwiseAbs2();
    error_ += error_M;
    error_square_ += error_M.cwiseAbs2();
    ++count_;
  }
  long count() const noexcept { return count_; }
  // Of both accelerations the AHRS' over the encoders', axis by axis; 1 when they agree. Needs
  // motion along the axis.
  Vec3 scale() const noexcept {
    return Vec3::Ones() + product_.cwiseQuotient(square_.cwiseMax(1e-9));
  }
  // Root mean square of the difference, all axes, its mean removed [m/s^2].
  double residual() const noexcept {
    if (count_ == 0) return 0;
    const double n = static_cast<double>(count_);
    return std::sqrt((error_square_ / n - (error_ / n).cwiseAbs2()).sum());
  }

 private:
  Vec3 product_ = Vec3::Zero(), square_ = Vec3::Zero();
  Vec3 error_ = Vec3::Zero(), error_square_ = Vec3::Zero();
  long count_ = 0;
};

}  // namespace farhand
