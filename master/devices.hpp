// The devices a scene can name, as one closed variant; a driver is one more entry.
#pragma once

#include <optional>
#include <string>
#include <variant>

#include "master/falcon_usb/device.hpp"
#include "master/haptic_device.hpp"
#include "master/replay_hand.hpp"
#include "master/sim_hand.hpp"

namespace farhand {

using AnyDevice =
    std::variant<SimHand<FalconGeometry>, SimHand<TwinDeltaGeometry>, ReplayHand, FalconUsb>;

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

// What its user is to do now, if that has changed; for one thread, which need not be the loop's.
inline std::optional<std::string> advice(AnyDevice& device) {
  auto* falcon = std::get_if<FalconUsb>(&device);
  return falcon == nullptr ? std::nullopt : falcon->advice();
}

}  // namespace farhand
