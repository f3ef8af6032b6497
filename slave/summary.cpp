#include "slave/summary.hpp"

namespace farhand {

void SlaveSummary::add(const SlaveTick& t) noexcept {
  ++ticks;
  left_out += !t.answers;
  ++ticks_in_mode[static_cast<std::size_t>(t.mode)];
  limits.add(t.limits);
  const double f = t.F_E_S.force.norm();
  const bool touching = f > kContactForce;
  if (touching) force.add(f);
  if (!t.coupled) return;
  ++coupled_ticks;
  largest_turn = std::max(largest_turn, t.turn_M.norm());
  (touching ? position_contact : position_free).add((t.X_SE_target.p - t.X_SE.p).norm());
  (touching ? rotation_contact : rotation_free)
      .add(rotation_vector(t.X_SE_target.R * t.X_SE.R.transpose()).norm());
}

}  // namespace farhand
