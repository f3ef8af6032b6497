// The devices a scene can name, as one closed variant; a driver is one more entry.
#pragma once

#include <variant>

#include "master/haptic_device.hpp"
#include "master/replay_hand.hpp"
#include "master/sim_hand.hpp"

namespace farhand {

using AnyDevice = std::variant<SimHand<FalconGeometry>, SimHand<TwinDeltaGeometry>, ReplayHand>;

// Hardware: what is written moves something.
inline bool is_real(const AnyDevice& device) noexcept {
  return std::visit([](const auto& d) { return d.kReal; }, device);
}
inline HandleReading read(AnyDevice& device, TimePoint now) noexcept {
  return std::visit([&](auto& d) { return d.read(now); }, device);
}
inline void write(AnyDevice& device, TimePoint now, const Vec6& tau) noexcept {
  std::visit([&](auto& d) { d.write(now, tau); }, device);
}

}  // namespace farhand
