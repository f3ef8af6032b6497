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
  const bool alive = now - sent_at_ < keep_alive_;
  const bool news =
      events != told_ || (alive && (force_.due(felt.force, now) || torque_.due(felt.torque, now)));
  if (!news && alive && !repeats(now)) return false;
  if (news) news_at_ = now, repeated_ = 0;
  sent_at_ = now;
  told_ = events;
  force_.sent(felt.force, now);
  torque_.sent(felt.torque, now);
  return true;
}

bool AnswerDeadband::repeats(TimePoint now) noexcept {
  if (repeated_ == kRepeats.size() || now - news_at_ < kRepeats[repeated_]) return false;
  ++repeated_;
  return true;
}

}  // namespace farhand
