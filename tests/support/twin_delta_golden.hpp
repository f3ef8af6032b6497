// What the golden vectors of the twin-delta handle share.
#pragma once

#include "master/twin_delta.hpp"
#include "tests/support/golden.hpp"

namespace farhand::golden {

inline TwinDeltaPose twin_delta_pose(const Json& in) {
  return {
      .p_MH = column(in["p"]), .axis = Vec3(column(in["u_raw"])).normalized(), .length = in["l"]};
}

inline TwinDeltaJacobian twin_delta_jacobian(const Json& in) {
  const TwinDeltaPose pose = twin_delta_pose(in);
  return jacobian(TwinDeltaGeometry{.k = in["k"]}, pose, handle_axes(pose.axis));
}

// The files order a wrench [torque; force].
inline Wrench moment_first(const Vec6& f) {
  return {.force = f.tail<3>(), .torque = f.head<3>()};
}
inline Vec6 moment_first(const Wrench& F) {
  Vec6 f;
  f << F.torque, F.force;
  return f;
}

}  // namespace farhand::golden
