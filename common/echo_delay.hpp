// The delay that a compensation must be prepared for, as each side knows it by itself: the age of
// the own message that the peer's newest one echoes (Header::echo_sent), peak held. It has the
// network both ways in it, the peer's waiting, and every gap, since it grows until an answer
// comes.
#pragma once

#include <algorithm>

#include "common/time.hpp"

namespace farhand {

struct EchoDelayConfig {
  double Ts = 0.001;
  double margin = 0.002;  // [s] on top of the peak: one tick of either side
  double decay = 2;       // [s] time constant with which the peak comes down to the present age
  double most = 0.5;      // [s] the answer stays below
};

// By rule, where the round trip goes beyond all that a method is sized for: the share, 1 to 0, with
// which the sides are still coupled. Whole to 1.2 times `most`, none from 1.6 times on; a queue
// that delays everything by a second is seen here, not in the age since the last arrival.
inline double coupling_share(const EchoDelayConfig& c, Duration echo_age) noexcept {
  return std::clamp(4 - 2.5 * seconds(echo_age) / c.most, 0.0, 1.0);
}

class EchoDelay {
 public:
  explicit EchoDelay(const EchoDelayConfig& config) noexcept
      : config_(config), peak_(config.margin) {}

  // Once per tick. echo_age: now less the stamp echoed, on the own clock; negative counts as 0.
  // Returns T* [s]: up at once, down slowly.
  double step(Duration echo_age) noexcept {
    const double age = std::clamp(seconds(echo_age), 0.0, config_.most) + config_.margin;
    peak_ += std::min(1.0, config_.Ts / config_.decay) * std::min(age - peak_, 0.0);
    peak_ = std::min(std::max(age, peak_), config_.most);
    return peak_;
  }
  double delay() const noexcept { return peak_; }

 private:
  EchoDelayConfig config_;
  double peak_;
};

}  // namespace farhand
