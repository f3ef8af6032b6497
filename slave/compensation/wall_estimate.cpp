#include "slave/compensation/wall_estimate.hpp"

#include <algorithm>
#include <cmath>

namespace farhand {
namespace {

// What is known beforehand, against 1 N of noise: standard deviations of 10 kN/m, 10 N, 30 N s/m.
const Vec3 kPrior(1e8, 1e2, 1e3);
constexpr int kFirstWords = 20;  // [ticks] before they are believed

}  // namespace

void WallEstimate::reset() noexcept {
  theta_ = Vec3(config_.first, 0, 0);
  P_ = kPrior.asDiagonal();
  learnt_ = 0;
  k_ = config_.first;
}

void WallEstimate::step(double x, double v, double F) noexcept {
  if (std::abs(v) > config_.min_speed) {
    const Vec3 phi(x, 1, v), P_phi = P_ * phi;
    const Vec3 gain = P_phi / (config_.forgetting + phi.dot(P_phi));
    theta_ += gain * (F - theta_.dot(phi));
    P_ = (P_ - gain * P_phi.transpose()) / config_.forgetting;
    P_ = (0.5 * (P_ + P_.transpose())).eval();
    const double over = (P_.diagonal().array() / kPrior.array()).maxCoeff();
    if (over > 1) P_ /= over;
    ++learnt_;
  }
  if (!learnt()) return;
  const double k = std::clamp(theta_[0], config_.least, config_.most);
  k_ += std::min(1.0, config_.Ts / (k > k_ ? config_.rise : config_.fall)) * (k - k_);
}

bool WallEstimate::learnt() const noexcept {
  return learnt_ >= kFirstWords;
}

double WallEstimate::b() const noexcept {
  return !learnt() ? 0 : std::clamp(theta_[2], 0.0, config_.most_damping);
}

}  // namespace farhand
