// What a late or missing wrench becomes. For now the plainest rule: hold it for a while, then let
// it fade.
#pragma once

#include <algorithm>

#include "common/time.hpp"

namespace farhand {

struct CompensationConfig {
  Duration hold = std::chrono::milliseconds(20);  // full strength up to this age
  Duration fade = std::chrono::milliseconds(80);  // then linearly to zero in this time, > 0
};

// Share, 1 to 0, of a wrench of this age that may still be felt.
constexpr double fade(const CompensationConfig& config, Duration age) noexcept {
  if (age <= config.hold) return 1;
  if (age >= config.hold + config.fade) return 0;
  return 1 - seconds(age - config.hold) / seconds(config.fade);
}

// A share that may drop at once, and comes back slowly: after a gap the hand may be far from where
// the coupling is at rest.
class FadeIn {
 public:
  static constexpr double kTime = 0.3;  // [s] from none to whole
  double step(double share, double Ts) noexcept {
    share_ = std::min(share, share_ + Ts / kTime);
    return share_;
  }

 private:
  double share_ = 1;  // at the first coupling the spring is at rest
};

}  // namespace farhand
