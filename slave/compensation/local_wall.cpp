#include "slave/compensation/local_wall.hpp"

#include <algorithm>
#include <cmath>

namespace farhand {

Vec3 WallFinder::step(const Vec3& x_wish, const Vec3& F_felt, const Vec3& x_sd, const Vec3& x,
                      const Vec3& v, const Vec3& F_e) noexcept {
  const double f = F_e.norm();
  if (in_contact_) wall_.net -= F_e.dot(x - x_);
  x_ = x;
  if (!in_contact_ && f > config_.touch) touch(x_sd, x, F_e);
  in_contact_ = in_contact_ && f > config_.miss_felt;
  if (in_contact_) {
    estimate_.step((x - x_0_).dot(wall_.n), v.dot(wall_.n), F_e.dot(wall_.n));
    place(x_sd, F_e);
  }
  const double expected = k_hold_ * (x_sd - x_hold_).dot(wall_.n);
  const bool misses = expected > config_.miss_expected && f < config_.miss_felt;
  missed_ = wall_.known && misses ? missed_ + config_.Ts : 0;
  if (missed_ >= config_.miss_time) wall_.known = false;
  wall_.sure = sure();
  return hold_back(x_wish, F_felt);
}

void WallFinder::touch(const Vec3& x_sd, const Vec3& x, const Vec3& F_e) noexcept {
  const Vec3 n = F_e.normalized();
  in_contact_ = true;
  ++wall_.contacts;
  wall_.net = 0;
  x_0_ = x;
  if (wall_.known && n.dot(wall_.n) > kSameWall) return slide(x_sd);
  estimate_.reset();
  wall_ = {.known = true, .x_w = x_sd, .n = n, .contacts = wall_.contacts};
  wall_.k = in_series(std::min(config_.bias * estimate_.k(), config_.max_stiffness));
  settled_ = x_hold_ = x_sd;
  k_hold_ = in_series(config_.feared_stiffness);
}

// Along the known wall to where it is touched now: a normal that turns must not swing it round a
// place left long ago.
void WallFinder::slide(const Vec3& x_sd) noexcept {
  for (Vec3* at : {&wall_.x_w, &x_hold_, &settled_})
    *at = x_sd - (x_sd - *at).dot(wall_.n) * wall_.n;
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
  const double k = config_.bias * estimate_.k();
  const double share = std::min(1.0, config_.Ts / config_.place_time);
  const double hold_share = std::min(1.0, config_.Ts / config_.hold_time);
  wall_.k = in_series(std::min(k, config_.max_stiffness));
  k_hold_ = in_series(estimate_.learnt() ? k : std::max(k, config_.feared_stiffness));
  wall_.b = estimate_.b();
  wall_.n = (wall_.n + share * (F_e.normalized() - wall_.n)).normalized();
  const double F = F_e.dot(wall_.n);
  wall_.x_w += share * (x_sd - F / wall_.k * wall_.n - wall_.x_w);
  x_hold_ += hold_share * (x_sd - F / k_hold_ * wall_.n - x_hold_);
  settled_ += std::min(1.0, config_.Ts / config_.settle_time) * (wall_.x_w - settled_);
}

// With the robot's servo.
double WallFinder::in_series(double k) const noexcept {
  return k * config_.servo_stiffness / (k + config_.servo_stiffness);
}

Vec3 WallFinder::hold_back(const Vec3& x_wish, const Vec3& F_felt) const noexcept {
  if (!wall_.known || !(k_hold_ > 0)) return x_wish;
  const double felt = std::max(F_felt.dot(wall_.n), 0.0) + config_.over_felt;
  const double over = (x_wish - x_hold_).dot(wall_.n) - std::min(felt, config_.max_force) / k_hold_;
  return over > 0 ? Vec3(x_wish - over * wall_.n) : x_wish;
}

}  // namespace farhand
