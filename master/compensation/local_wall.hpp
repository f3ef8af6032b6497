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
// A hand deep in a wall that it met late is pushed out as far as its tank E pays for: no agreement
// makes the force larger than c F^2 / (2 k_L) <= E allows. Then the force is steady, and the hand
// feels the wall from where it is.
//
// Guaranteed by the operator's tank alone (master/compensation/operator_tank.hpp): a local model
// has no passivity of its own. Costs: the drag D v; a wall that moves is felt late, the hand
// floats meanwhile; what is not a wall (friction along it) is not felt. Gaps do not matter until
// the wall moves.
#pragma once

#include "common/local_wall.hpp"
#include "master/compensation/operator_tank.hpp"

namespace farhand {

struct WallRendererConfig {
  double Ts = 0.001;
  double agree_time = 0.15;      // [s]
  double stiffness_rate = 0.02;  // of k_L per tick
  double drag = 12;              // D [N s/m]
  double covered = 0.25;         // c: share of the spring's energy that the tank must hold
};

class WallRenderer {
 public:
  explicit WallRenderer(const WallRendererConfig& config) noexcept : config_(config) {}

  // Force of the handle on the wall and the drag. `told`: by the newest message, not known before
  // the first. allowed: by the tank; of a force that drives the hand the wall gives way for what
  // is not allowed.
  Vec3 step(const Vec3& x_m, const Vec3& v_m, const LocalWall& told,
            const OperatorAllowance& allowed) noexcept;
  const LocalWall& wall() const noexcept { return wall_; }  // as rendered
  void forget() noexcept { wall_.known = false; }

 private:
  bool is_another(const LocalWall& told) const noexcept;
  void agree(const Vec3& x_m, const LocalWall& told, double energy) noexcept;
  void come(const Vec3& x_m, const LocalWall& told, double energy) noexcept;
  double agree_share() const noexcept { return std::min(1.0, config_.Ts / config_.agree_time); }
  double depth(const Vec3& x_m) const noexcept { return (x_m - wall_.x_w).dot(wall_.n); }

  WallRendererConfig config_;
  LocalWall wall_;
};

}  // namespace farhand
