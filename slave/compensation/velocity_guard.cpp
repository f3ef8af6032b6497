#include "slave/compensation/velocity_guard.hpp"

#include "common/limits.hpp"

namespace farhand {

Vec3 VelocityGuard::step(const Vec3& v, const Vec3& stretch, const Vec3& F_e) noexcept {
  const Vec3 F = contact(F_e), out = allowed(v, stretch, F);
  budget_.charge(-config_.Ts * out.dot(F));
  return out;
}

Vec3 VelocityGuard::step(const Vec3& v, const Vec3& stretch, const Vec3& F_e,
                         const Vec3& moved) noexcept {
  const Vec3 F = contact(F_e);
  budget_.charge(-moved.dot(F));
  return allowed(v, stretch, F);
}

Vec3 VelocityGuard::contact(const Vec3& F_e) const noexcept {
  return F_e - clamp_norm(F_e, config_.noise);
}

Vec3 VelocityGuard::allowed(const Vec3& v, const Vec3& stretch, const Vec3& F_e) noexcept {
  const double outflow = std::max(v.dot(F_e), 0.0) * config_.Ts;
  const double lack = outflow - std::max(budget_.left(), 0.0), force2 = F_e.squaredNorm();
  acting_ = lack > 0;
  const Vec3 stopped = acting_ ? Vec3(v - lack / (force2 * config_.Ts) * F_e) : v;
  return stopped + drift(stopped, stretch, F_e);
}

Vec3 VelocityGuard::drift(const Vec3& v, const Vec3& stretch, const Vec3& F_e) const noexcept {
  const Vec3 add = clamp_norm(Vec3(stretch / config_.drift_time), config_.drift_speed);
  const double surplus = budget_.left() - std::max(v.dot(F_e), 0.0) * config_.Ts;
  const double cost = add.dot(F_e) * config_.Ts;
  if (cost <= 0 || cost <= surplus) return add;
  return std::max(surplus, 0.0) / cost * add;
}

}  // namespace farhand
