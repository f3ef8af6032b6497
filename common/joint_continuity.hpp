// Whether one reading of joints continues the one before: no joint leaps. After a longer gap, or a
// leap that stays, it takes two readings that agree.
#pragma once

#include <cmath>
#include <cstdint>

#include "common/geometry.hpp"
#include "common/time.hpp"

namespace farhand {

class JointContinuity {
 public:
  enum class Verdict : std::uint8_t {
    continues,  // also the first reading of all
    leapt,      // no reading to act upon, nor is one that is not finite
    elsewhere   // two agree, and are a leap away from what was believed before
  };

  // speed: what each joint is capable of [rad/s].
  explicit JointContinuity(const Vec6& speed) noexcept : speed_(speed) {}

  // Of every reading, in the order of time.
  Verdict step(TimePoint now, const Vec6& q) noexcept {
    if (!near(q)) return judge(now, q);
    read_ = {q, now};
    return Verdict::continues;
  }

 private:
  static constexpr double kLeap = 0.05;  // [rad] beside twice what its speed allows
  struct Place {
    Vec6 q = Vec6::Zero();
    TimePoint at{};
  };

  // Nothing to think about.
  bool near(const Vec6& q) const noexcept {
    if (!certain_) return false;
    for (int i = 0; i < 6; ++i)
      if (!(std::abs(q[i] - read_.q[i]) <= kLeap)) return false;
    return true;
  }
  Verdict judge(TimePoint now, const Vec6& q) noexcept;
  bool leaps(const Place& from, TimePoint now, const Vec6& q) const noexcept;

  Vec6 speed_;
  bool seen_ = false;
  bool certain_ = false;  // the last reading did not leap
  Place read_;            // that is it
  Place believed_;        // if it leapt, the last that did not
};

}  // namespace farhand
