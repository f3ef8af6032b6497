// Which answers the slave leaves out: those that tell nothing new (common/deadband.hpp). New is a
// force or torque off by more than what is felt, if the master has a use for them, and any change
// of what the master acts by otherwise: mode, reason, coupling, presses seen, and whether there is
// an orientation to turn the handle to, which changes only with that or the coupling. The robot's
// pose and the limits that act are not: nobody acts by them.
#pragma once

#include "common/deadband.hpp"
#include "common/wire.hpp"

namespace farhand {

// Both with the same keep-alive.
struct AnswerDeadbandConfig {
  DeadbandConfig force, torque;
};

class AnswerDeadband {
 public:
  explicit AnswerDeadband(const AnswerDeadbandConfig& config) noexcept
      : force_(config.force), torque_(config.torque) {}

  // Once per tick. If so the answer must be sent: it is what later ones are compared with.
  bool due(const SlaveToMaster& out, bool force_wanted, TimePoint now) noexcept;

 private:
  struct Events {
    Mode mode = Mode::disconnected;
    Reason reason = Reason::no_partner;
    bool coupled = false;
    bool has_robot = false;
    std::uint32_t dead_man_presses = 0, clutch_presses = 0;
    bool operator==(const Events&) const = default;
  };

  Deadband force_, torque_;
  Events told_;
};

}  // namespace farhand
