// The master's half of the model-mediated method (common/local_wall.hpp): the wall is rendered
// where the handle is now, so neither delay nor jitter nor loss is in the loop that the hand
// closes,
//
//   F = max(0, k_L (x_m - x_L) . n + b v . n) n + D v,        x_L' = (x_w - x_L) / 0.15 s
//
// and agrees with the slave's slowly, linearly (a limited rate would limit-cycle). When the first
// contact is told, or one with another wall, the hand is inside already: the wall begins where the
// hand is. A normal that turns never puts a hand that is free into the wall. The stiffness
// moves by at most 2 %/ms, at constant force. A wall that is gone fades in the same 0.15 s.
//
// Guaranteed by the operator's tank alone (master/compensation/operator_tank.hpp): a local model
// has no passivity of its own. Costs: the drag D v; a wall that moves is felt late, the hand
// floats meanwhile; what is not a wall (friction along it) is not felt. Gaps do not matter until
// the wall moves.
#pragma once

#include "common/local_wall.hpp"

namespace farhand {

struct WallRendererConfig {
  double Ts = 0.001;
  double agree_time = 0.15;      // [s]
  double stiffness_rate = 0.02;  // of k_L per tick
  double drag = 12;              // D [N s/m]
};

class WallRenderer {
 public:
  explicit WallRenderer(const WallRendererConfig& config) noexcept : config_(config) {}

  // Force of the handle on the wall and the drag. `told`: by the newest message, not known before
  // the first. out_share: of a force that drives the hand, what the tank allows; the wall gives
  // way for the rest.
  Vec3 step(const Vec3& x_m, const Vec3& v_m, const LocalWall& told, double out_share) noexcept;
  const LocalWall& wall() const noexcept { return wall_; }  // as rendered
  void forget() noexcept { wall_.known = false; }

 private:
  bool is_another(const LocalWall& told) const noexcept;
  void agree(const Vec3& x_m, const LocalWall& told) noexcept;
  double depth(const Vec3& x_m) const noexcept { return (x_m - wall_.x_w).dot(wall_.n); }

  WallRendererConfig config_;
  LocalWall wall_;
};

}  // namespace farhand
