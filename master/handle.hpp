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
  double twist = 0;              // of H against G [rad]
};

// Translates only: H, G and M have the same axes, and torques of a wrench are ignored.
struct FalconHandle {
  FalconGeometry geometry;
  FalconForward at;  // of the last sample: where the next search starts
  FalconJacobian J{};

  void update(const Vec6& theta, HandlePose& pose) noexcept;
  Status map_forces(const HandlePose& pose) noexcept;
  Vec6 torque(const Wrench& F_G) const noexcept;
  Wrench wrench(const Vec6& tau) const noexcept;
  Wrench edge_wrench(const WorkspaceEdge& edge) const noexcept;
};

struct TwinDeltaHandle {
  TwinDeltaGeometry geometry;
  TwinDeltaForward at;  // of the last sample
  TwinDeltaJacobian J{};

  void update(const Vec6& theta, HandlePose& pose) noexcept;
  Status map_forces(const HandlePose& pose) noexcept;
  Vec6 torque(const Wrench& F_G) const noexcept;
  Wrench wrench(const Vec6& tau) const noexcept;
  Wrench edge_wrench(const WorkspaceEdge& edge) const noexcept;
};

using Handle = std::variant<FalconHandle, TwinDeltaHandle>;

// Brings `pose`, that of the last sample, to the motor angles theta [rad], or says in its status
// why it cannot and leaves the rest (x_h is kept where a twin delta's handle lies along X).
// Remembers what map_forces() and the next sample need.
inline void update(Handle& handle, const Vec6& theta, HandlePose& pose) noexcept {
  std::visit([&](auto& h) { h.update(theta, pose); }, handle);
}
// Solves the map between wrenches and motors at the pose that update() made: once per tick, for
// all who need it. Not ok: that of the kinematics, singular, or out_of_limits, outside the accepted
// workspace, where the map exists and the motors shall give nothing.
inline Status map_forces(Handle& handle, const HandlePose& pose) noexcept {
  return std::visit([&](auto& h) { return h.map_forces(pose); }, handle);
}
// Motor torques [N m] with which the handle pushes the hand with F_G (at H, axes of G), and the
// wrench of motor torques, by the map of map_forces(); zero where there is none. A Falcon uses the
// first three.
inline Vec6 torque(const Handle& handle, const Wrench& F_G) noexcept {
  return std::visit([&](const auto& h) { return h.torque(F_G); }, handle);
}
inline Wrench wrench(const Handle& handle, const Vec6& tau) noexcept {
  return std::visit([&](const auto& h) { return h.wrench(tau); }, handle);
}

// Wrench on the hand near the end of the accepted workspace, at H, axes of G, by the same map.
inline Wrench edge_wrench(const Handle& handle, const WorkspaceEdge& edge) noexcept {
  return std::visit([&](const auto& h) { return h.edge_wrench(edge); }, handle);
}

// Handle velocity from pose differences through one pole. Ts [s]; the first sample is at rest.
class HandleVelocity {
 public:
  HandleVelocity(double cutoff_hz, double Ts) noexcept;
  const Twist& step(const Pose& X_MH) noexcept;  // at H, axes of M
  // The next pose is elsewhere, and no motion led there.
  void restart() noexcept {
    primed_ = false;
    V_MH_ = {};
  }

 private:
  double gain_per_Ts_;
  double gain_;
  bool primed_ = false;
  Pose last_;
  Twist V_MH_;
};

}  // namespace farhand
