// The slave's half of the model-mediated method (common/local_wall.hpp). The robot follows the
// handle; what it touches is estimated and told. The surface is placed by the force that is
// measured,
//
//   x_w = x_sd - F_e / k_c,    k_c = k Kp / (k + Kp)
//
// in the target's coordinate, so that at rest the master's model gives exactly F_e, however wrong k
// is. k is taken larger than estimated: the residual loop's small gain |k_e - k| < |k + Z_hand|
// holds at any delay from k_e / 2 on.
//
// While the wall stands, the target goes no deeper than max_force means, nor than what the hand
// felt when it was there, and over_felt: the hand, which hits a wall that it does not know yet,
// would press for a whole round trip, and one that the master may not push back (its tank is empty)
// for ever. Where both sides agree on the wall this changes nothing.
//
// In a gap the robot goes on, slows and rests (common/concealment.hpp), and estimates on.
#pragma once

#include "common/local_wall.hpp"
#include "slave/compensation/wall_estimate.hpp"

namespace farhand {

struct WallFinderConfig {
  double Ts = 0.001;
  double servo_stiffness = 20000;  // Kp [N/m] of the robot at the tool
  double bias = 1.1;               // of k over its estimate
  double max_stiffness = 4000;     // [N/m] of k, as the handle can render it
  double touch = 0.5;              // [N] a contact begins
  double max_force = 20;           // [N] to which the target is held back, and
  double over_felt = 5;            // [N] by which it may press more than the hand feels;
  double feared_stiffness = 5000;  // [N/m] for which that is sure before the wall's is learnt
  double place_time = 0.01;        // [s] filter of x_w and n
  double hold_time = 0.1;  // [s] of what the target is held back by: a loop around the servo
  double miss_expected = 0.8, miss_felt = 0.2, miss_time = 0.02;  // [N], [s]: no wall any more
  double settle_time = 0.3, settled_within = 0.001;  // [s], [m]: a wall that stands still
  WallEstimateConfig estimate;
};

class WallFinder {
 public:
  explicit WallFinder(const WallFinderConfig& config) noexcept
      : config_(config), estimate_(config.estimate) {}

  // The target in place of x_wish, where the handle is thought to be, and F_felt, of the handle on
  // what it feels, of the same message. x, v: robot, measured; F_e: robot on environment; x_sd:
  // where the target is, whoever limited it since the last tick.
  Vec3 step(const Vec3& x_wish, const Vec3& F_felt, const Vec3& x_sd, const Vec3& x, const Vec3& v,
            const Vec3& F_e) noexcept;
  const LocalWall& wall() const noexcept { return wall_; }
  // Places known so far mean others now.
  void forget() noexcept;
  const WallEstimate& estimate() const noexcept { return estimate_; }

 private:
  void touch(const Vec3& x_sd, const Vec3& x, const Vec3& F_e) noexcept;
  void slide(const Vec3& x_sd) noexcept;
  void place(const Vec3& x_sd, const Vec3& F_e) noexcept;
  bool sure() const noexcept;
  double in_series(double k) const noexcept;
  Vec3 hold_back(const Vec3& x_wish, const Vec3& F_felt) const noexcept;

  WallFinderConfig config_;
  WallEstimate estimate_;
  LocalWall wall_;
  bool in_contact_ = false;
  // As the target is held back by: not as soft as the handle may need it, for a target that moves
  // by more than the force says swings.
  double k_hold_ = 0;
  Vec3 x_hold_ = Vec3::Zero();
  double missed_ = 0;            // [s]
  Vec3 settled_ = Vec3::Zero();  // x_w through a slow filter
  Vec3 x_0_ = Vec3::Zero();      // where the contact began
  Vec3 x_ = Vec3::Zero();        // of the last tick
};

}  // namespace farhand
