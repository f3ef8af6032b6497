#include "slave/compensation/local_wall.hpp"

#include <algorithm>
#include <cmath>

namespace farhand {

Vec3 WallFinder::step(const Vec3& x_wish, const Vec3& x_sd, const Vec3& x, const Vec3& v,
                      const Vec3& F_e) noexcept {
  const double f = F_e.norm();
  if (in_contact_) wall_.net -= F_e.dot(x_sd - x_sd_);
  x_sd_ = x_sd;
  if (!in_contact_ && f > config_.touch) touch(x_sd, x, F_e);
  in_contact_ = in_contact_ && f > config_.miss_felt;
  if (in_contact_) {
    estimate_.step((x - x_0_).dot(wall_.n), v.dot(wall_.n), F_e.dot(wall_.n));
    place(x_sd, F_e);
  }
  const double expected = wall_.k * (x_sd - wall_.x_w).dot(wall_.n);
  const bool misses = expected > config_.miss_expected && f < config_.miss_felt;
  missed_ = wall_.known && misses ? missed_ + config_.Ts : 0;
  if (missed_ >= config_.miss_time) wall_.known = false;
  wall_.sure = sure();
  return hold_back(x_wish);
}

void WallFinder::touch(const Vec3& x_sd, const Vec3& x, const Vec3& F_e) noexcept {
  constexpr double kOtherWall = 0.8;  // cosine of the normals
  const Vec3 n = F_e.normalized();
  in_contact_ = true;
  ++wall_.contacts;
  wall_.net = 0;
  x_0_ = x;
  if (wall_.known && n.dot(wall_.n) > kOtherWall) return;
  estimate_.reset();
  wall_ = {.known = true, .x_w = x_sd, .n = n, .contacts = wall_.contacts};
  settled_ = x_sd;
}

void WallFinder::forget() noexcept {
  wall_.known = wall_.sure = in_contact_ = false;
  missed_ = 0;
}

bool WallFinder::sure() const noexcept {
  const double moves = (wall_.x_w - settled_).dot(wall_.n);
  return wall_.known && estimate_.learnt() && std::abs(moves) < config_.settled_within;
}

void WallFinder::place(const Vec3& x_sd, const Vec3& F_e) noexcept {
  const double k = std::min(config_.bias * estimate_.k(), config_.max_stiffness);
  const double share = std::min(1.0, config_.Ts / config_.place_time);
  wall_.k = k * config_.servo_stiffness / (k + config_.servo_stiffness);
  wall_.b = estimate_.b();
  wall_.n = (wall_.n + share * (F_e.normalized() - wall_.n)).normalized();
  const Vec3 x_w = x_sd - F_e.dot(wall_.n) / wall_.k * wall_.n;
  wall_.x_w += share * (x_w - wall_.x_w);
  settled_ += std::min(1.0, config_.Ts / config_.settle_time) * (wall_.x_w - settled_);
}

Vec3 WallFinder::hold_back(const Vec3& x_wish) const noexcept {
  if (!wall_.known || !(wall_.k > 0)) return x_wish;
  const double over = (x_wish - wall_.x_w).dot(wall_.n) - config_.max_force / wall_.k;
  return over > 0 ? Vec3(x_wish - over * wall_.n) : x_wish;
}

}  // namespace farhand
