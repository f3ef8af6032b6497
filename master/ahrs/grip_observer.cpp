#include "master/ahrs/grip_observer.hpp"

#include <algorithm>
#include <cmath>

namespace farhand {
namespace {

struct Kalman {
  Mat3 F = Mat3::Identity();
  Mat3 Q = Mat3::Zero();
  double R = 0;  // of the position
  Mat3 P = Mat3::Zero();

  // One step; its gains.
  Vec3 step() noexcept {
    P = F * P * F.transpose() + Q;
    const Vec3 gain = P.col(0) / (P(0, 0) + R);
    P -= gain * P.row(0);
    P = 0.5 * (P + P.transpose()).eval();
    return gain;
  }
};

// States p, v, bias; the acceleration is an input with white noise.
Kalman aligned_model(const GripObserverConfig& c) noexcept {
  Kalman k{.R = c.position_noise * c.position_noise};
  const double h = c.Ts, q = c.acceleration_noise * c.acceleration_noise;
  k.F << 1, h, -h * h / 2, 0, 1, -h, 0, 0, 1;
  k.Q << q * h * h * h / 3, q * h * h / 2, 0, q * h * h / 2, q * h, 0, 0, 0,
      c.bias_walk * c.bias_walk * h;
  k.P.diagonal() << k.R, 1, 1;
  return k;
}

// States p, v, a; white jerk.
Kalman encoder_model(const GripObserverConfig& c) noexcept {
  Kalman k{.R = c.position_noise * c.position_noise};
  const double h = c.Ts, q = c.jerk * c.jerk, h2 = h * h, h3 = h2 * h;
  k.F << 1, h, h2 / 2, 0, 1, h, 0, 0, 1;
  k.Q << q * h3 * h2 / 20, q * h2 * h2 / 8, q * h3 / 6, q * h2 * h2 / 8, q * h3 / 3, q * h2 / 2,
      q * h3 / 6, q * h2 / 2, q * h;
  return k;
}

}  // namespace

GripObserver::GripObserver(const GripObserverConfig& config) noexcept : config_(config) {
  Kalman aligned = aligned_model(config);
  constexpr double kSettled = 20;  // [s]
  for (double t = 0; t < kSettled; t += config.Ts) aligned_gain_ = aligned.step();
  Kalman encoder = encoder_model(config);
  encoder.P.topLeftCorner<2, 2>() = aligned.P.topLeftCorner<2, 2>();
  encoder.P(2, 2) = config.first_acceleration * config.first_acceleration;
  for (Vec3& gain : gain_) gain = encoder.step();
}

const GripMotionState& GripObserver::step(const Vec3& p) noexcept {
  ++tick_;
  if (known_ == 0) {
    now_ = {.p = p};
    age_ = kTicks - 1;
    aligned_tick_ = -1;
  }
  moment(tick_).encoder = p;
  if (known_ > 0) advance(now_, tick_, age_);
  age_ = std::min(age_ + 1, kTicks - 1);
  known_ = std::min(known_ + 1, kTicks);
  moment(tick_).state = now_;
  return now_;
}

void GripObserver::advance(GripMotionState& s, std::int64_t tick, int age) const noexcept {
  const double h = config_.Ts;
  const Vec3& gain = gain_[static_cast<std::size_t>(age)];
  s.p += h * s.v + h * h / 2 * s.a;
  s.v += h * s.a;
  const Vec3 r = moment(tick).encoder - s.p;
  s.p += gain[0] * r;
  s.v += gain[1] * r;
  s.a += gain[2] * r;
}

void GripObserver::acceleration(double ticks_ago, const Vec3& a) noexcept {
  const double at = static_cast<double>(tick_) - ticks_ago;
  if (!(ticks_ago >= 0 && ticks_ago < known_ - 1)) return;
  const bool follows = aligned_tick_ >= 0 &&
                       (at - sample_tick_) * config_.Ts <= config_.longest_gap &&
                       tick_ - aligned_tick_ < known_;
  if (follows && !(at > sample_tick_)) return;
  if (follows) {
    advance_aligned(at, a);
  } else {
    aligned_tick_ = static_cast<std::int64_t>(std::floor(at));
    aligned_ = moment(aligned_tick_).state;
  }
  sample_tick_ = at;
  sample_ = a;
  now_ = aligned_;
  now_.a = a - bias_;
  age_ = 0;
  for (std::int64_t tick = aligned_tick_ + 1; tick <= tick_; ++tick, ++age_)
    advance(now_, tick, std::min(age_, kTicks - 1));
  moment(tick_).state = now_;
}

// All whole ticks up to this sample.
void GripObserver::advance_aligned(double until, const Vec3& a) noexcept {
  const double h = config_.Ts;
  for (; static_cast<double>(aligned_tick_ + 1) <= until; ++aligned_tick_) {
    const double middle = static_cast<double>(aligned_tick_) + 0.5;
    const double share = std::clamp((middle - sample_tick_) / (until - sample_tick_), 0.0, 1.0);
    const Vec3 drive = sample_ + share * (a - sample_) - bias_;
    aligned_.p += h * aligned_.v + h * h / 2 * drive;
    aligned_.v += h * drive;
    const Vec3 r = moment(aligned_tick_ + 1).encoder - aligned_.p;
    aligned_.p += aligned_gain_[0] * r;
    aligned_.v += aligned_gain_[1] * r;
    bias_ += aligned_gain_[2] * r;  // this gain is negative
  }
}

void GripObserver::restart() noexcept {
  known_ = 0;
}

}  // namespace farhand
