// The two mechanisms behind one surface: motor angles to handle pose and velocity, handle wrench to
// motor torques. A closed variant; a third handle is one more struct with the same members.
#pragma once

#include <variant>

#include "common/geometry.hpp"
#include "common/status.hpp"
#include "master/falcon.hpp"
#include "master/twin_delta.hpp"

namespace farhand {

struct HandlePose {
  Status status = Status::not_finite;
  Pose X_MH;                     // twist included
  Mat3 R_MG = Mat3::Identity();  // handle axes without twist: where wrenches are felt
};

struct MotorTorques {
  Status status =
      Status::not_finite;   // out_of_limits: outside the accepted workspace; tau is zero unless ok
  Vec6 tau = Vec6::Zero();  // [N m]; a Falcon uses the first three
};

// Translates only: H, G and M have the same axes, and torques of a wrench are ignored.
struct FalconHandle {
  FalconGeometry geometry;
  FalconForward at;  // of the last sample: where the next search starts

  HandlePose pose(const Vec6& theta) noexcept;
  MotorTorques torque(const Wrench& F_G) const noexcept;
};

struct TwinDeltaHandle {
  TwinDeltaGeometry geometry;
  TwinDeltaForward at;
  Mat3 R_MG =
      Mat3::Identity();  // of the last sample: its x_h is kept where the handle lies along X

  HandlePose pose(const Vec6& theta) noexcept;
  MotorTorques torque(const Wrench& F_G) const noexcept;
};

using Handle = std::variant<FalconHandle, TwinDeltaHandle>;

// Pose from motor angles [rad]; remembers what torque() and the next sample need.
inline HandlePose pose(Handle& handle, const Vec6& theta) noexcept {
  return std::visit([&](auto& h) { return h.pose(theta); }, handle);
}
// Motor torques with which the handle, where pose() saw it last, pushes the hand with F_G (at H,
// axes of G).
inline MotorTorques torque(const Handle& handle, const Wrench& F_G) noexcept {
  return std::visit([&](const auto& h) { return h.torque(F_G); }, handle);
}

// Handle velocity from pose differences through one pole. Ts [s]; the first sample is at rest.
class HandleVelocity {
 public:
  HandleVelocity(double cutoff_hz, double Ts) noexcept;
  const Twist& step(const Pose& X_MH) noexcept;  // at H, axes of M

 private:
  double gain_per_Ts_;
  double gain_;
  bool primed_ = false;
  Pose last_;
  Twist V_MH_;
};

}  // namespace farhand
