// Stiffness and damping of what the robot touches, along one direction, by recursive least squares
// with forgetting on F = k x + F_0 + b v.
//
// Only a moving contact tells stiffness from offset, so it learns above min_speed alone. The value
// given out rises fast and falls slowly: a model too soft is felt as a push that comes late, one
// too hard only as slow agreement.
#pragma once

#include "common/geometry.hpp"

namespace farhand {

struct WallEstimateConfig {
  double Ts = 0.001;
  double forgetting = 0.998;
  double min_speed = 0.003;         // [m/s]
  double rise = 0.1, fall = 2;      // [s] time constants
  double first = 1000;              // [N/m] until it learns
  double least = 50, most = 20000;  // [N/m]
  double most_damping = 20;         // [N s/m]
};

class WallEstimate {
 public:
  explicit WallEstimate(const WallEstimateConfig& config) noexcept : config_(config) { reset(); }

  void reset() noexcept;  // another wall
  // Depth x from some point of this contact, along it; its rate; the force there.
  void step(double x, double v, double F) noexcept;
  double k() const noexcept { return k_; }
  double b() const noexcept;
  bool learnt() const noexcept;  // from motion, and not only what it began with

 private:
  WallEstimateConfig config_;
  Vec3 theta_ = Vec3::Zero();  // k, F_0, b
  Mat3 P_ = Mat3::Zero();
  int learnt_ = 0;  // [ticks]
  double k_ = 0;
};

}  // namespace farhand
