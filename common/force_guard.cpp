#include "common/force_guard.hpp"

namespace farhand {

Vec3 ForceGuard::step(const Vec3& F_wished, const Vec3& x) noexcept {
  const Vec3 F_wanted = F_wished.allFinite() ? F_wished : Vec3(Vec3::Zero());
  if ((x - x_).norm() > config_.max_speed * config_.Ts) let_go();
  const Vec3 moved = ticks_ > 0 ? Vec3(x - x_) : Vec3::Zero();
  budget_.charge(F_.dot(moved));
  budget_.repay(added_.dot(moved));

  const double left = budget_.left();
  const double share = left < 0 ? std::max(1 + left / config_.reserve, 0.0) : 1;
  // Where the force will do its work, if the acceleration stays.
  const Vec3 next = ticks_ > 1 ? Vec3(2 * moved - moved_) : moved;
  ticks_ = std::min(ticks_ + 1, 2);
  x_ = x, moved_ = moved, F_ = share * F_wanted, added_ = Vec3::Zero();
  const double outflow = std::max(-F_.dot(next), 0.0), move2 = next.squaredNorm();
  const double lack = outflow - left;
  acting_ = lack > 0;
  if (!acting_ || !(move2 > 0)) return F_;
  const double stopped = std::min(lack, outflow);
  const double repaid = std::min(lack - stopped, config_.max_damping / config_.Ts * move2);
  added_ = (stopped + repaid) / move2 * next;
  return F_ + added_;
}

}  // namespace farhand
