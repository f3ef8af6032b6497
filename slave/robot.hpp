// The seam between the slave's loop and a robot, simulated or real: six joints that take torques,
// and a force/torque sensor at the tool.
#pragma once

#include <concepts>

#include "common/geometry.hpp"
#include "common/limits.hpp"
#include "common/time.hpp"

namespace farhand {

struct RobotReading {
  bool ok = false;         // false: nothing below may be used
  Vec6 q = Vec6::Zero();   // [rad]
  Vec6 dq = Vec6::Zero();  // [rad/s]
  Wrench F_E_S{};  // what the sensor says: the robot on what it holds and touches, at E, S axes;
                   // bias and tool weight included
};

// Anything else is no reading.
inline bool plausible(const RobotReading& r) noexcept {
  return r.q.cwiseAbs().sum() + r.dq.cwiseAbs().sum() < kAbsurd;
}

// read() and write() never block, allocate or throw. A torque written holds until the next.
template <typename R>
concept Robot = requires(R robot, TimePoint now, const Vec6& tau) {
  { R::kReal } -> std::convertible_to<bool>;  // hardware, not simulated
  { robot.read(now) }
  noexcept->std::same_as<RobotReading>;
  { robot.write(now, tau) }
  noexcept->std::same_as<void>;
};

}  // namespace farhand
