// Whether one reading of joints continues the one before: no joint leaps. After a longer gap, or a
// leap that stays, it takes two readings that agree.
#pragma once

#include <algorithm>
#include <optional>

#include "common/geometry.hpp"
#include "common/time.hpp"

namespace farhand {

class JointContinuity {
 public:
  enum class Verdict : std::uint8_t {
    continues,  // also the first reading of all
    leapt,      // no reading to act upon
    elsewhere   // two agree, and are a leap away from what was believed before
  };

  // speed: what each joint is capable of [rad/s].
  explicit JointContinuity(const Vec6& speed) noexcept : speed_(speed) {}

  // Of every reading, finite, in the order of time.
  Verdict step(TimePoint now, const Vec6& q) noexcept {
    const bool leapt = read_ && leaps(*read_, now, q);
    if (leapt && !doubted_) believed_ = *read_;
    const bool elsewhere = doubted_ && !leapt && leaps(believed_, now, q);
    doubted_ = leapt;
    read_ = {q, now};
    if (leapt) return Verdict::leapt;
    return elsewhere ? Verdict::elsewhere : Verdict::continues;
  }

 private:
  struct Place {
    Vec6 q = Vec6::Zero();
    TimePoint at{};
  };

  bool leaps(const Place& from, TimePoint now, const Vec6& q) const noexcept {
    constexpr double kLeap = 0.05;  // [rad] beside twice what its speed allows
    constexpr Duration kGap = std::chrono::milliseconds(50);
    const double since = seconds(std::clamp(now - from.at, Duration::zero(), kGap));
    const Vec6 way = 2 * since * speed_ + Vec6::Constant(kLeap);
    return ((q - from.q).cwiseAbs() - way).maxCoeff() > 0;
  }

  Vec6 speed_;
  std::optional<Place> read_;  // the last reading
  bool doubted_ = false;       // it leapt
  Place believed_;             // if so, the last that did not
};

}  // namespace farhand
