// Where the peer's handle is thought to be when no message comes: linear dead reckoning from the
// newest one. Up to some 100 ms of hand motion nothing better was found, and beyond it everything
// is worse than standing still; so the velocity fades after 50 ms and the pose rests from 100 ms
// on. A force is never extrapolated: it is held and faded (master/compensation.hpp).
//
// When a message ends the gap, the pose jumps by the error of the reckoning; what follows limits
// the speed.
#pragma once

#include <algorithm>

#include "common/time.hpp"

namespace farhand {

struct ConcealmentConfig {
  Duration full = std::chrono::milliseconds(50);  // up to this age at the message's velocity
  Duration fade = std::chrono::milliseconds(50);  // then linearly to rest in this time, > 0
};

// Of a message of this age: x + path(age) v is where the sender is thought to be, pace(age) v how
// fast. x and v: position or rotation vector from the message's orientation, and its velocity,
// low-passed by the sender (30..60 Hz).
constexpr double pace(const ConcealmentConfig& c, Duration age) noexcept {
  return std::clamp(1 - seconds(age - c.full) / seconds(c.fade), 0.0, 1.0);
}
constexpr double path(const ConcealmentConfig& c, Duration age) noexcept {  // [s]
  const double faded = std::clamp(seconds(age - c.full), 0.0, seconds(c.fade));
  return std::clamp(seconds(age), 0.0, seconds(c.full)) +
         faded * (1 - faded / (2 * seconds(c.fade)));
}

}  // namespace farhand
