// What the simulated handle needs of its mechanism: encoder angles and the motors' push at a place,
// and where the mechanism ends. One specialisation per geometry, the same members in each.
//
// The mechanism ends half way between the workspace the master accepts and the singularity behind
// it (half the bounds of accepted()), so that a scene can leave the one and never reaches the
// other.
#pragma once

#include <numbers>

#include "master/falcon.hpp"
#include "master/hand_plant.hpp"
#include "master/twin_delta.hpp"

namespace farhand {

template <typename Geometry>
class HandLinkage;

template <>
class HandLinkage<FalconGeometry> {
 public:
  static constexpr bool kRotates = false;
  static constexpr int kMotors = 3;
  static constexpr double kMaxTwist = 0;
  static Vec3 middle() noexcept { return {0, 0, 0.120}; }  // of the workspace, p_MH
  static Vec3 down_M() noexcept { return -Vec3::UnitY(); }

  explicit HandLinkage(const FalconGeometry& g) noexcept : g_(g) {}

  // True and everything below at the new place, or false, outside, and nothing changed.
  bool solve(const HandState& state) noexcept;
  const Vec6& theta() const noexcept { return theta_; }  // [rad], unused ones 0
  Mat3 R_MG() const noexcept { return Mat3::Identity(); }
  // Load of the handle's own motors on it.
  HandLoad motors(const Vec6& tau) const noexcept;

 private:
  FalconGeometry g_;
  FalconJacobian J_;
  Vec6 theta_ = Vec6::Zero();
};

template <>
class HandLinkage<TwinDeltaGeometry> {
 public:
  static constexpr bool kRotates = true;
  static constexpr int kMotors = 6;
  static constexpr double kMaxTwist = std::numbers::pi;
  static Vec3 middle() noexcept { return {0.18, 0, 0}; }
  static Vec3 down_M() noexcept { return -Vec3::UnitZ(); }

  explicit HandLinkage(const TwinDeltaGeometry& g) noexcept : g_(g) {}

  bool solve(const HandState& state) noexcept;
  const Vec6& theta() const noexcept { return theta_; }
  const Mat3& R_MG() const noexcept { return J_.R_MG; }
  HandLoad motors(const Vec6& tau) const noexcept;
  // What the sensors at the ends of the grip feel of the user's wrench.
  EndForces ends(const Wrench& F_user_G) const noexcept { return end_forces(J_, F_user_G); }

 private:
  TwinDeltaGeometry g_;
  TwinDeltaJacobian J_;
  Vec6 theta_ = Vec6::Zero();
};

}  // namespace farhand
