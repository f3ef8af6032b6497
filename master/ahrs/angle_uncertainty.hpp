// How far an angle may be off that is integrated from a rate with noise and an unknown, nearly
// constant error, and corrected by measurements now and then: the covariance of a Kalman filter on
// (angle, rate error).
#pragma once

#include <algorithm>
#include <cmath>
#include <numbers>

namespace farhand {

class AngleUncertainty {
 public:
  AngleUncertainty() = default;
  // Standard deviations of angle [rad] and rate error [rad/s].
  AngleUncertainty(double angle, double rate) noexcept
      : angle_(angle * angle), rate_(rate * rate) {}

  double sigma() const noexcept { return std::min(std::sqrt(angle_), std::numbers::pi); }  // [rad]

  // dt [s] of integration; noise [rad/s/sqrt(Hz)], walk of the rate error [rad/s/sqrt(s)].
  void predict(double dt, double noise, double walk) noexcept {
    angle_ += dt * (2 * cross_ + dt * rate_ + noise * noise);
    cross_ += dt * rate_;
    rate_ += dt * walk * walk;
  }
  // The rate was anything of this standard deviation [rad/s] for so long [s].
  void unknown(double dt, double rate) noexcept {
    const double sigma = std::sqrt(angle_) + dt * rate;
    angle_ = sigma * sigma;
  }
  // The share that a measurement with this standard deviation [rad] deserves.
  double share(double sigma) const noexcept { return angle_ / (angle_ + sigma * sigma); }
  void measured(double sigma) noexcept {
    const double total = angle_ + sigma * sigma;
    rate_ -= cross_ * cross_ / total;
    cross_ *= sigma * sigma / total;
    angle_ *= sigma * sigma / total;
  }
  // The rate error is known as well as this [rad/s], if it was not better known.
  void know_rate(double sigma) noexcept {
    if (rate_ <= sigma * sigma) return;
    cross_ *= sigma * sigma / rate_;
    rate_ = sigma * sigma;
  }

 private:
  double angle_ = 0, cross_ = 0, rate_ = 0;
};

}  // namespace farhand
