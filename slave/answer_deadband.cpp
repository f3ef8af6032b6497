#include "slave/answer_deadband.hpp"

namespace farhand {

bool AnswerDeadband::due(const SlaveToMaster& out, bool force_wanted, TimePoint now) noexcept {
  const Events events{.mode = out.mode,
                      .reason = out.reason,
                      .coupled = out.coupled,
                      .has_robot = out.has_robot,
                      .dead_man_presses = out.dead_man_presses_seen,
                      .clutch_presses = out.clutch_presses_seen};
  const Wrench felt = force_wanted ? out.F_E_M : Wrench{};
  if (events == told_ && !force_.due(felt.force, now) && !torque_.due(felt.torque, now))
    return false;
  told_ = events;
  force_.sent(felt.force, now);
  torque_.sent(felt.torque, now);
  return true;
}

}  // namespace farhand
