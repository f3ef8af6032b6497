#include "master/summary.hpp"

namespace farhand {

void MasterSummary::add(const MasterTick& t) noexcept {
  if (ticks++ == 0) start_ = t.now;
  ++ticks_in_mode[static_cast<std::size_t>(t.mode)];
  limits.add(t.limits);
  ahrs_lost_ticks += t.ahrs == AhrsState::lost;
  if (t.reason == Reason::turn_handle) {
    ++turn_ticks;
    largest_turn = std::max(largest_turn, t.turn_M.norm());
  }
  if (t.handle.status == Status::ok && t.position_controlled) add_position_control(t);
  if (t.mode != Mode::engaged) return;
  worst_age = std::max(worst_age, t.age);
  const bool touching = t.F_env_G.force.norm() > kContactForce;
  if (t.user_felt)
    (touching ? force_contact : force_free).add((t.F_user_G.force - t.F_env_G.force).norm());
  force_felt.add(t.F_G.force.norm());
}

void MasterSummary::add_position_control(const MasterTick& t) noexcept {
  constexpr double kSettled = 0.0015;  // [m], the publication's accuracy
  const Vec3 e = t.p_MH_target - t.handle.X_MH.p;
  position_error.add(e.norm());
  peak_control_force = std::max(peak_control_force, t.F_G.force.norm());
  if (e.cwiseAbs().maxCoeff() > kSettled) last_outside_s = seconds(t.now - start_);
}

}  // namespace farhand
