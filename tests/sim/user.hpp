// The operator's fingers: in the fault phase dead-man and clutch are pressed and released at
// random, by somebody who sometimes heeds the display and sometimes does not; afterwards as an
// operator would: let go, clear a fault by the clutch, wait for READY, press and hold. All along
// the hand turns the handle when told to.
#pragma once

#include "common/random.hpp"
#include "master/master.hpp"

namespace farhand {

class User {
 public:
  explicit User(std::uint64_t seed) : random_(seed) {}

  struct Buttons {
    bool dead_man = false, clutch = false;
  };
  // t: since the episode's begin. shown: what the master's last tick displayed.
  Buttons carelessly(Duration t);
  Buttons carefully(Duration t, Mode master, Mode slave);

  // How fast the hand turns the handle [rad/s], M axes, by what the master's last tick displayed.
  Vec3 turn(Duration t, const MasterTick& shown);

  // Of the careful half: when first both were READY with the dead-man released, and then ENGAGED.
  std::optional<Duration> ready, engaged;

 private:
  double exponential(double mean) { return -mean * std::log(1 - random_.uniform()); }
  void flip(Duration t, bool& button, Duration& next, double held, double released);

  Random random_;
  static constexpr Duration kReaction = std::chrono::milliseconds(200);
  Buttons now_;
  std::optional<Duration> turn_told_;
  Duration next_dead_man_{}, next_clutch_{};
  std::optional<Duration> since_;  // of the present careful step
};

}  // namespace farhand
