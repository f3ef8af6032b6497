// Perceptual deadband (Hinterseer et al. 2008, IEEE Trans. Signal Process. 56, 588; IEEE
// 1918.1.1-2024): nobody feels a change below some share of what is felt already (Weber's law), so
// a message is due only when what the receiver has is off by more,
//
//   |y - y_hat| > max(k |y_hat|, floor)        y_hat: the last sent, held
//
// per force, torque or position. A message carries absolute state and sums, so those left out cost
// nothing else: energies of the guards stay right. k = 0.10 is below what is felt; from 0.27 on
// tasks suffer (Chaudhari et al. 2011). The floor must be some five times the sensor's noise, or
// the noise is what is sent. Gaps: a keep-alive bounds the age, so that silence still means loss; a
// message lost costs at most that long.
#pragma once

#include <algorithm>

#include "common/geometry.hpp"
#include "common/time.hpp"

namespace farhand {

struct DeadbandConfig {
  double share = 0.10;  // k
  double floor = 0.03;  // [N], or in the unit of y
  Duration keep_alive = std::chrono::milliseconds(50);
};

class Deadband {
 public:
  explicit Deadband(const DeadbandConfig& config) noexcept : config_(config) {}

  // Whether the receiver needs to hear y now. If the message goes out for whatever reason, say so.
  bool due(const Vec3& y, TimePoint now) const noexcept {
    const double allowed = std::max(config_.share * sent_.norm(), config_.floor);
    return !started_ || now - at_ >= config_.keep_alive || !((y - sent_).norm() <= allowed);
  }
  void sent(const Vec3& y, TimePoint now) noexcept { sent_ = y, at_ = now, started_ = true; }

 private:
  DeadbandConfig config_;
  bool started_ = false;
  Vec3 sent_ = Vec3::Zero();
  TimePoint at_{};
};

}  // namespace farhand
