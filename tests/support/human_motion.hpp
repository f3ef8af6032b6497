// A hand that reaches here and there, one axis: minimum-jerk reaches of 0.3..1.2 s between random
// places (Flash and Hogan 1985), a tremor of 9 Hz, and the noise of a sensor.
#pragma once

#include <cmath>
#include <cstdint>

#include "common/pid.hpp"
#include "common/random.hpp"
#include "tests/support/periodic.hpp"

namespace farhand {

struct HumanMotionConfig {
  double reach = 0.15;      // [m] places lie within +- reach
  double tremor = 0.0002;   // [m]
  double noise = 0.000020;  // [m] standard deviation
};

class HumanMotion {
 public:
  HumanMotion(const HumanMotionConfig& config, std::uint64_t seed) : c_(config), random_(seed) {}

  // At the next sample, Ts later.
  double step(double Ts) {
    t_ += Ts;
    if (t_ > begin_ + length_) {
      begin_ = t_, length_ = 0.3 + 0.9 * random_.uniform();
      from_ = to_, to_ = c_.reach * (2 * random_.uniform() - 1);
    }
    const double s = (t_ - begin_) / length_;
    return from_ + (to_ - from_) * s * s * s * (10 - s * (15 - 6 * s)) +
           c_.tremor * std::sin(kTurn * 9 * t_) + c_.noise * random_.normal();
  }

 private:
  HumanMotionConfig c_;
  Random random_;
  double t_ = 0, begin_ = 0, length_ = 0, from_ = 0, to_ = 0;
};

}  // namespace farhand
