// The handle's own dynamics as a model has them, for the stages that hide it from the hand:
//
//   m x'' = F_u + F_m - B x' - F_k tanh(|x'| / v_k) x'/|x'| + weight
//
// once for the translation (M axes), once for the tilt of the handle axis (M axes, square to it),
// once for the twist (no weight in the last two). A Falcon has the first alone.
#pragma once

#include <cmath>

#include "common/geometry.hpp"
#include "master/handle.hpp"

namespace farhand {

// Loads or motions along x y z of M, about x y z of M (tilt), and of the twist: N, N m, N m or
// m/s, rad/s, rad/s and so on.
using DeviceAxes = Eigen::Array<double, 7, 1>;

inline DeviceAxes to_device(const Mat3& R_MG, const Wrench& F_G) noexcept {
  DeviceAxes out;
  out << (R_MG * F_G.force).array(), (R_MG.leftCols<2>() * F_G.torque.head<2>()).array(),
      F_G.torque.z();
  return out;
}
inline Wrench from_device(const Mat3& R_MG, const DeviceAxes& load) noexcept {
  Wrench F{.force = R_MG.transpose() * load.segment<3>(0).matrix(),
           .torque = R_MG.transpose() * load.segment<3>(3).matrix()};
  F.torque.z() = load[6];
  return F;
}

// One kind of motion: [kg, N s/m, N, m/s] or [kg m^2, N m s, N m, rad/s].
struct DeviceGroup {
  double inertia = 1;  // > 0
  double damping = 0;
  double friction = 0;
  double slip = 0.005;  // v_k > 0: the speed at which friction is at 76 % of its size

  // What stands between speed and drag: B + F_k tanh(s / v_k) / s; finite at rest.
  double drag(double speed) const noexcept {
    const double s = speed / slip;
    return damping + friction / slip * (s > 1e-4 ? std::tanh(s) / s : 1.0);
  }
};

struct DeviceModel {
  DeviceGroup translation{1.0, 4, 0.8, 0.005};
  DeviceGroup tilt{0.01, 0.02, 0.02, 0.05};
  DeviceGroup twist{5e-4, 2e-3, 0, 0.05};
  Vec3 weight_M = Vec3(0, 0, -2);  // [N] left after the counterbalance
};

// One value per group on its axes.
inline DeviceAxes per_axis(double translation, double tilt, double twist) noexcept {
  DeviceAxes out;
  out << translation, translation, translation, tilt, tilt, tilt, twist;
  return out;
}
inline DeviceAxes drag(const DeviceModel& m, const DeviceAxes& v) noexcept {
  return per_axis(m.translation.drag(v.segment<3>(0).matrix().norm()),
                  m.tilt.drag(v.segment<3>(3).matrix().norm()), m.twist.drag(std::abs(v[6])));
}

}  // namespace farhand
