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

  void update(const Vec6& theta, HandlePose& pose) noexcept;
  MotorTorques torque(const HandlePose& pose, const Wrench& F_G) const noexcept;
  Wrench edge_wrench(const HandlePose& pose, const WorkspaceEdge& edge) const noexcept;
};

struct TwinDeltaHandle {
  TwinDeltaGeometry geometry;
  TwinDeltaForward at;  // of the last sample

  void update(const Vec6& theta, HandlePose& pose) noexcept;
  MotorTorques torque(const HandlePose& pose, const Wrench& F_G) const noexcept;
  Wrench edge_wrench(const HandlePose& pose, const WorkspaceEdge& edge) const noexcept;
};

using Handle = std::variant<FalconHandle, TwinDeltaHandle>;

// Brings `pose`, that of the last sample, to the motor angles theta [rad], or says in its status
// why it cannot and leaves the rest (x_h is kept where a twin delta's handle lies along X).
// Remembers what torque() and the next sample need.
inline void update(Handle& handle, const Vec6& theta, HandlePose& pose) noexcept {
  std::visit([&](auto& h) { h.update(theta, pose); }, handle);
}
// Motor torques with which the handle pushes the hand with F_G (at H, axes of G), at the pose that
// update() made.
inline MotorTorques torque(const Handle& handle, const HandlePose& pose,
                           const Wrench& F_G) noexcept {
  return std::visit([&](const auto& h) { return h.torque(pose, F_G); }, handle);
}

// Wrench on the hand near the end of the accepted workspace, at H, axes of G.
inline Wrench edge_wrench(const Handle& handle, const HandlePose& pose,
                          const WorkspaceEdge& edge) noexcept {
  return std::visit([&](const auto& h) { return h.edge_wrench(pose, edge); }, handle);
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
