// A hand at the emulated Falcon. By itself it does what a user does: it pulls the grip out and
// pushes it in, which homes it, brings it back, holds the gesture that arms it, and then the dead
// man's button, while it rests or moves gently. All of it anew whenever it begins again.
//
// Told something, it gives that up and does only what it is told from then on, a line each:
//
//   home                pulls the grip out, pushes it in and brings it back to the middle
//   move X Y Z          brings it there, in M and millimetres, and holds it as firmly as a jig
//   let go              leaves it to the motors
//   press BUTTON ...    centre, forward, plus, minus; until they are released
//   release             all buttons
//   weight GRAMS        hangs so much on the grip instead of what hangs there; whoever holds it
//                       does not feel that
//
// Its time passes by a millisecond per answer of the device at most: who asks more slowly than a
// thousand times a second sees it in slow motion, not in leaps.
#pragma once

#include <mutex>
#include <optional>
#include <string>
#include <vector>

#include "master/falcon_usb/emulator/emulated_hand.hpp"

namespace farhand::falcon_usb {

enum class HandMotion : std::uint8_t {
  none,    // it holds the grip in the middle and waits to be told
  still,   // once armed, it rests
  circle,  // of 2 cm radius, across the device's axis, once in 4 s
};

// The gesture is held from 3.5 s to 4.3 s, the dead man's button from 5 s on.
SimHandConfig hand_script(HandMotion motion);

// Its time begins with the first answer of the device. Any thread may call anything.
class ScriptedHand {
 public:
  explicit ScriptedHand(HandMotion motion, const EmulatedHandConfig& device = {});

  void begin_again();
  // Throws a sentence if it does not understand the line, which then changes nothing.
  void tell(const std::string& line);
  // Once after each home and move: the grip is there and rests.
  bool arrived();

  Mechanism mechanism();

 private:
  TimePoint slowed(TimePoint now) noexcept;
  void bring(const std::vector<Vec3>& stops);
  void let_go();
  void press(std::uint8_t buttons);
  void replace(SimHandConfig next);
  Vec3 place();

  std::mutex mutex_;
  HandMotion motion_;
  EmulatedHandConfig device_;
  std::optional<EmulatedHand> hand_;
  std::optional<TimePoint> asked_;  // last
  TimePoint time_{};                // the hand's own
  bool scripted_ = true, holds_ = true;
  std::uint8_t buttons_ = 0;        // that it was told to press
  double hung_ = 0;                 // [kg]
  std::optional<double> rests_at_;  // [s] of the hand's plant, while it is on its way
};

}  // namespace farhand::falcon_usb
