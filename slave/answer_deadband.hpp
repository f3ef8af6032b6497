// Which answers the slave leaves out: those that tell nothing new (common/deadband.hpp). New is a
// force or torque off by more than what is felt, if the master has a use for them, and any change
// of what the master acts by otherwise: mode, reason, coupling, presses seen, and whether there is
// an orientation to turn the handle to, which changes only with that or the coupling. The robot's
// pose and the limits that act are not: nobody acts by them. An answer with news is said again 2,
// 5 and 10 ms later, for the first may be lost.
#pragma once

#include <array>
#include <cstddef>

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
      : force_(config.force), torque_(config.torque), keep_alive_(config.force.keep_alive) {}

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

  bool repeats(TimePoint now) noexcept;

  static constexpr std::array<Duration, 3> kRepeats = {
      std::chrono::milliseconds(2), std::chrono::milliseconds(5), std::chrono::milliseconds(10)};

  Deadband force_, torque_;
  Duration keep_alive_;
  Events told_;
  TimePoint sent_at_{};
  TimePoint news_at_{};
  std::size_t repeated_ = kRepeats.size();
};

}  // namespace farhand
