#include "master/compensation/local_wall.hpp"

#include <algorithm>
#include <cmath>

namespace farhand {

Vec3 WallRenderer::step(const Vec3& x_m, const Vec3& v_m, const LocalWall& told,
                        const OperatorAllowance& allowed) noexcept {
  const Vec3 drag = config_.drag * v_m;
  if (told.known && (!wall_.known || is_another(told))) {
    wall_ = told;
    wall_.x_w += std::max(depth(x_m), 0.0) * wall_.n;
  }
  if (!wall_.known) return drag;
  agree(x_m, told, allowed.energy);
  const double in = depth(x_m), v = v_m.dot(wall_.n);
  if (!(in > 0)) return drag;
  if (v < 0 && allowed.share < 1) wall_.x_w += (1 - allowed.share) * in * wall_.n;
  return std::max(0.0, wall_.k * depth(x_m) + wall_.b * v) * wall_.n + drag;
}

bool WallRenderer::is_another(const LocalWall& told) const noexcept {
  return told.contacts != wall_.contacts && told.n.dot(wall_.n) < kSameWall;
}

void WallRenderer::agree(const Vec3& x_m, const LocalWall& told, double energy) noexcept {
  const double in = depth(x_m);
  if (!told.known) {  // fades
    if (in > 0) wall_.x_w += agree_share() * in * wall_.n;
    constexpr double kNothing = 0.05;  // [N]
    wall_.known = wall_.k * in > kNothing;
    return;
  }
  const double F = wall_.k * std::max(in, 0.0), step = config_.stiffness_rate * wall_.k;
  wall_.k = F > 0 ? std::clamp(told.k, wall_.k - step, wall_.k + step) : told.k;
  wall_.b = told.b;
  wall_.n = told.n;
  wall_.contacts = told.contacts;
  if (F > 0)
    wall_.x_w += (depth(x_m) - F / wall_.k) * wall_.n;
  else
    wall_.x_w += std::max(depth(x_m), 0.0) * wall_.n;
  come(x_m, told, energy);
}

// A hand that is driven until the tank is empty loses the force all at once, falls back, and is
// driven again: the force stops to grow before.
void WallRenderer::come(const Vec3& x_m, const LocalWall& told, double energy) noexcept {
  const double before = depth(x_m);
  wall_.x_w += agree_share() * (told.x_w - wall_.x_w);
  const double most = std::max(before, std::sqrt(2 * energy / (config_.covered * wall_.k)));
  wall_.x_w += std::max(depth(x_m) - most, 0.0) * wall_.n;
}

}  // namespace farhand
