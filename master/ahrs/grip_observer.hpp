// Position, velocity and acceleration of the grip from encoders at every tick and from an
// accelerometer that speaks more seldom and late. Per axis, gains fixed at construction:
//
//   Up to the last accelerometer sample, where both are known: the acceleration, interpolated
//   between samples and less its bias b, drives the model; the encoders correct it.
//     p- = p + h v + h^2/2 (a - b)   v- = v + h (a - b)
//     r = p_encoder - p-             p = p- + k1 r   v = v- + k2 r   b = b + k3 r (k3 < 0)
//   From there to now, where only the encoders are known: the acceleration goes on and the encoders
//   correct that, too, the more the longer ago the last sample is.
//     p- = p + h v + h^2/2 a         v- = v + h a    p = p- + g1 r   v = v- + g2 r   a = a + g3 r
//
// The gains are those of Kalman filters for the noise below. A late sample is taken where it
// belongs and the ticks since then are gone through again, at most kTicks. When samples cease, the
// second part simply goes on: its gains have become those of a filter that knows encoders only, so
// nothing jumps.
#pragma once

#include <array>
#include <cstdint>

#include "common/geometry.hpp"

namespace farhand {

struct GripObserverConfig {
  double Ts = 0.001;                 // [s] of a tick
  double position_noise = 4e-5;      // [m] of one encoder position, its step mostly
  double acceleration_noise = 0.01;  // [m/s^2/sqrt(Hz)]
  double bias_walk = 0.02;           // [m/s^2/sqrt(s)] its offset, tilt and place included
  double first_acceleration = 0.1;   // [m/s^2] how well a sample tells the acceleration
  double jerk = 6;                   // [m/s^3/sqrt(Hz)] of a hand
  double longest_gap = 0.05;         // [s] between samples, over which it is interpolated
};

struct GripMotionState {
  Vec3 p = Vec3::Zero();  // [m]
  Vec3 v = Vec3::Zero();  // [m/s]
  Vec3 a = Vec3::Zero();  // [m/s^2]
};

class GripObserver {
 public:
  static constexpr int kTicks = 128;  // memory

  explicit GripObserver(const GripObserverConfig& config) noexcept;

  // One tick: the encoders' position [m]. The first one is at rest.
  const GripMotionState& step(const Vec3& p) noexcept;
  // Acceleration of the grip [m/s^2] at an instant, in ticks before the last step, not negative.
  // Left out: older than the memory, or not after the last one.
  void acceleration(double ticks_ago, const Vec3& a) noexcept;
  // Encoders were silent: the next step is a first one. The bias stays.
  void restart() noexcept;

  const GripMotionState& state() const noexcept { return now_; }
  const Vec3& bias() const noexcept { return bias_; }  // [m/s^2]
  // Position by the encoders, ticks before the last step; whether it is remembered.
  bool remembers(int ticks_ago) const noexcept { return ticks_ago >= 0 && ticks_ago < known_; }
  const Vec3& position(int ticks_ago) const noexcept { return moment(tick_ - ticks_ago).encoder; }

 private:
  struct Moment {
    Vec3 encoder = Vec3::Zero();
    GripMotionState state;
  };
  Moment& moment(std::int64_t tick) noexcept {
    return memory_[static_cast<std::size_t>(tick % kTicks)];
  }
  const Moment& moment(std::int64_t tick) const noexcept {
    return memory_[static_cast<std::size_t>(tick % kTicks)];
  }
  void advance_aligned(double until, const Vec3& a) noexcept;
  void advance(GripMotionState& s, std::int64_t tick, int age) const noexcept;

  GripObserverConfig config_;
  Vec3 aligned_gain_;
  std::array<Vec3, kTicks> gain_;  // by ticks since the last sample

  std::array<Moment, kTicks> memory_{};
  std::int64_t tick_ = -1;  // of the last step
  int known_ = 0;           // moments in memory
  GripMotionState now_;
  int age_ = kTicks - 1;  // ticks from the last sample to now

  GripMotionState aligned_;         // at aligned_tick_
  std::int64_t aligned_tick_ = -1;  // -1: none
  double sample_tick_ = 0;          // of the last sample
  Vec3 sample_ = Vec3::Zero();
  Vec3 bias_ = Vec3::Zero();
};

}  // namespace farhand
