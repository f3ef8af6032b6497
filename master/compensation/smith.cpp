#include "master/compensation/smith.hpp"

#include <algorithm>
#include <cmath>

namespace farhand {

Vec3 SmithPredictor::step(const Vec3& x_m, const Vec3& v_m, const Vec3& F_e, TimePoint acted,
                          TimePoint now) noexcept {
  if (!started_ || !x_.allFinite()) start(x_m);
  past_[next_] = F_;  // the robot's, too, is measured before it moves
  next_ = (next_ + 1) % kLength, known_ = std::min(known_ + 1, kLength);
  const Vec3 correction = F_ - then(std::max(seconds(now - acted), 0.0) / config_.Ts);
  move(x_m, v_m);
  return F_e + config_.share * correction;
}

// It may be in the wall already, and what presses there is no news then.
void SmithPredictor::start(const Vec3& x_m) noexcept {
  started_ = true;
  known_ = 0;
  x_ = x_m, v_.setZero();
  F_ = wall_force();
}

Vec3 SmithPredictor::wall_force() const noexcept {
  const LocalWall& w = config_.wall;
  const double depth = (x_ - w.x_w).dot(w.n);
  return (depth > 0 ? std::max(0.0, w.k * depth + w.b * v_.dot(w.n)) : 0) * w.n;
}

void SmithPredictor::move(const Vec3& x_m, const Vec3& v_m) noexcept {
  constexpr int kSubsteps = 4;
  const double h = config_.Ts / kSubsteps;
  for (int i = 0; i < kSubsteps; ++i) {
    F_ = wall_force();
    const Vec3 lead = x_m - (kSubsteps - 1 - i) * h * v_m - x_;
    v_ += h / config_.mass * (config_.Kp * lead + config_.Kd * (v_m - v_) - F_);
    x_ += h * v_;
  }
}

// Between two ticks, linear; before the line began, as it began.
Vec3 SmithPredictor::then(double ticks_ago) const noexcept {
  const double most = static_cast<double>(known_ - 1), t = std::min(ticks_ago, most);
  const auto i = static_cast<std::size_t>(t);
  const auto at = [&](std::size_t ago) -> const Vec3& {
    return past_[(next_ + 2 * kLength - 1 - std::min(ago, known_ - 1)) % kLength];
  };
  return at(i) + (t - static_cast<double>(i)) * (at(i + 1) - at(i));
}

}  // namespace farhand
