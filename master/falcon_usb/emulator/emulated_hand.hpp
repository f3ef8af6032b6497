// The mechanism of the emulated Falcon: the simulated hand and handle of sim_hand.hpp, seen through
// encoder counts and driven by motor counts.
#pragma once

#include "master/falcon_usb/counts.hpp"
#include "master/falcon_usb/emulator/emulated_processor.hpp"
#include "master/sim_hand.hpp"

namespace farhand::falcon_usb {

struct EmulatedHandConfig {
  FalconGeometry geometry;
  double counts_per_newton_meter = kGainCharacterised;  // of the device's motors, as they are
  std::uint8_t dead_man = kButtonCentre;
  std::uint8_t clutch = kButtonForward;
};

// Must outlive the mechanism it makes. The hand's own encoder step should be 0.
class EmulatedHand {
 public:
  EmulatedHand(const EmulatedHandConfig& config, SimHandConfig hand)
      : config_(config), hand_(config.geometry, std::move(hand)) {}

  Mechanism mechanism() {
    return {.read = [this](TimePoint now) { return read(now); },
            .drive = [this](TimePoint now, const AxisWords& counts) { drive(now, counts); }};
  }
  const HandTruth& truth() const noexcept { return hand_.truth(); }

  GripState read(TimePoint now) noexcept {
    const HandleReading reading = hand_.read(now);
    const Eigen::Vector3i counts = counts_from_theta1(config_.geometry, reading.theta.head<3>());
    GripState out;
    for (int i = 0; i < 3; ++i) out.counts[i] = static_cast<std::int16_t>(counts[i]);
    if (reading.dead_man) out.buttons |= config_.dead_man;
    if (reading.clutch) out.buttons |= config_.clutch;
    return out;
  }
  void drive(TimePoint now, const AxisWords& counts) noexcept {
    Vec6 tau = Vec6::Zero();
    tau.head<3>() = torque_of_counts(counts, config_.counts_per_newton_meter);
    hand_.write(now, tau);
  }

 private:
  EmulatedHandConfig config_;
  SimHand<FalconGeometry> hand_;
};

}  // namespace farhand::falcon_usb
