// From the two force sensors at the ends of a twin delta's grip to the wrench of the user on the
// handle: each sensor's constant bias removed, mapped by L (twin-delta publication eq. 34 with its
// errata; reference section 6.2), the grip's weight removed. No filter: who closes a loop on it
// knows what delay it can bear.
#pragma once

#include "common/geometry.hpp"
#include "master/twin_delta.hpp"

namespace farhand {

struct HandleForceSensingConfig {
  EndForces bias{};      // [N], in each sensor's own axes: E1 in M, E2 in A2
  double grip_mass = 0;  // [kg] that the sensors carry, its centre at H
  Vec3 gravity_M = Vec3(0, 0, -kGravity);
};

class HandleForceSensing {
 public:
  explicit HandleForceSensing(const HandleForceSensingConfig& config) noexcept : config_(config) {}

  // raw: as read, bias and weight included. J: of the same instant. The user's wrench on the
  // handle, at H, in handle axes G. A reading that is not finite, or a J that is not ok: the last
  // value.
  const Wrench& step(const EndForces& raw, const TwinDeltaJacobian& J) noexcept;

 private:
  HandleForceSensingConfig config_;
  Wrench F_user_G_;
};

}  // namespace farhand
