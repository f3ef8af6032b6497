#include "tests/sim/user.hpp"

namespace farhand {

void User::flip(Duration t, bool& button, Duration& next, double held, double released) {
  if (t < next) return;
  button = !button;
  next = t + from_seconds(exponential(button ? held : released));
}

User::Buttons User::carelessly(Duration t) {
  flip(t, now_.dead_man, next_dead_man_, 1.5, 0.4);
  flip(t, now_.clutch, next_clutch_, 0.3, 2);
  return now_;
}

User::Buttons User::carefully(Duration t, Mode master, Mode slave) {
  if (!since_) {
    since_ = t;
    now_ = {};
  }
  const bool rested = t - *since_ >= kReaction;
  const bool engaged_both = master == Mode::engaged && slave == Mode::engaged;
  if (now_.dead_man) {
    if (engaged_both && !engaged) engaged = t;
    const bool still = engaged_both || (master == Mode::engaged && t - *since_ < 2 * kReaction);
    if (!still && rested) now_ = {}, since_ = t;
  } else if (rested && now_.clutch) {
    now_ = {}, since_ = t;
  } else if (rested && (master == Mode::fault || slave == Mode::fault)) {
    now_.clutch = true, since_ = t;
  } else if (rested && master == Mode::ready && slave == Mode::ready) {
    if (!ready) ready = t;
    now_.dead_man = true, since_ = t;
  }
  return now_;
}

Vec3 User::turn(Duration t, const MasterTick& shown) {
  constexpr double kGain = 4;  // [1/s]
  constexpr double kRate = 1;  // [rad/s]
  if (shown.reason != Reason::turn_handle && shown.slave_reason != Reason::turn_handle)
    turn_told_.reset();
  else if (!turn_told_)
    turn_told_ = t;
  if (!turn_told_ || t - *turn_told_ < kReaction) return Vec3::Zero();
  return clamp_norm(Vec3(kGain * shown.turn_M), kRate);
}

}  // namespace farhand
