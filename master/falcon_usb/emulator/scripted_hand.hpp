// A hand at the emulated Falcon that does what a user does: it pulls the grip out and pushes it in,
// which homes it, brings it back, holds the gesture that arms it, and then the dead man's button,
// while it rests or moves gently. All of it anew whenever it begins again.
#pragma once

#include <optional>

#include "master/falcon_usb/emulator/emulated_hand.hpp"

namespace farhand::falcon_usb {

enum class HandMotion : std::uint8_t {
  still,
  circle,  // of 2 cm radius, across the device's axis, once in 4 s
};

// The gesture is held from 3.5 s to 4.3 s, the dead man's button from 5 s on.
inline SimHandConfig hand_script(HandMotion motion) {
  SimHandConfig out{
      .user = OperatorConfig{},
      .presses = {{Button::dead_man, 3.5, 0.8}, {Button::clutch, 3.5, 0.8}, {Button::dead_man, 5}},
      .encoder_step = 0};
  out.device.weight = 0;
  MotionConfig& wish = out.user->motion;
  wish.reaches = {{0.5, 0.8, {0, 0, 0.03}}, {1.5, 0.8, {0, 0, -0.06}}, {2.5, 0.8, {0, 0, 0.03}}};
  if (motion == HandMotion::circle)
    wish.sines = {{.from = 5, .frequency = 0.25, .offset = {0.02, 0, 0}},
                  {.from = 6, .frequency = 0.25, .offset = {0, 0.02, 0}}};
  return out;
}

class ScriptedHand {
 public:
  explicit ScriptedHand(HandMotion motion) : motion_(motion) { begin_again(); }

  // Its time begins with the next answer of the device.
  void begin_again() { hand_.emplace(EmulatedHandConfig{}, hand_script(motion_)); }

  Mechanism mechanism() {
    return {.read = [this](TimePoint now) { return hand_->mechanism().read(now); },
            .drive = [this](TimePoint now,
                            const AxisWords& counts) { hand_->mechanism().drive(now, counts); }};
  }
  const HandTruth& truth() const noexcept { return hand_->truth(); }

 private:
  HandMotion motion_;
  std::optional<EmulatedHand> hand_;
};

}  // namespace farhand::falcon_usb
