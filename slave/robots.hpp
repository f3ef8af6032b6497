// The robots a scene can name, as one closed variant; a driver is one more entry.
#pragma once

#include <variant>

#include "slave/robot.hpp"
#include "slave/sim_arm.hpp"

namespace farhand {

using AnyRobot = std::variant<SimArm>;

// Hardware: what is written moves something.
inline bool is_real(const AnyRobot& robot) noexcept {
  return std::visit([](const auto& r) { return r.kReal; }, robot);
}
inline RobotReading read(AnyRobot& robot, TimePoint now) noexcept {
  return std::visit([&](auto& r) { return r.read(now); }, robot);
}
inline void write(AnyRobot& robot, TimePoint now, const Vec6& tau) noexcept {
  std::visit([&](auto& r) { r.write(now, tau); }, robot);
}

}  // namespace farhand
