// Vectors, poses, twists and wrenches, and the one table of frames.
//
//   M  master base. Falcon: base-platform centre, X to the user's right, Y up, Z from the base to
//   the user.
//      Twin delta: OXYZ of the handle, X from the base to the user, Z up.
//   H  the handle, twist included (what the hand holds)
//   G  the handle axes without twist (R_h of the reference: columns x_h, y_h, z_h = handle axis)
//   S  slave base: robot base, Z up
//   E  the tool (end effector) of the robot
//
// A name is spelt kind, from-to, expressed-in: p_MH is the position of H seen from M, X_SE a pose,
// v_MH the velocity of H in M, f_H_M a force on H written in M axes. Composition is right when the
// inner letters meet: X_SE = X_SM * X_ME.
#pragma once

#include <Eigen/Core>
#include <Eigen/Geometry>

namespace farhand {

using Vec3 = Eigen::Vector3d;
using Vec6 = Eigen::Matrix<double, 6, 1>;
using Mat3 = Eigen::Matrix3d;
using Mat6 = Eigen::Matrix<double, 6, 6>;
using Quat = Eigen::Quaterniond;

// X_AB: rotation R_AB (orthonormal, right-handed) and position p_AB [m] of B in A.
struct Pose {
  Mat3 R = Mat3::Identity();
  Vec3 p = Vec3::Zero();
};

// Angular [rad/s] and linear [m/s] velocity. Which axes and which point: the variable's name says
// it.
struct Twist {
  Vec3 angular = Vec3::Zero();
  Vec3 linear = Vec3::Zero();
};

inline constexpr double kGravity = 9.81;  // [m/s^2]

// Force [N] and torque [N m] at a point. Members are named so that no interface relies on their
// order.
struct Wrench {
  Vec3 force = Vec3::Zero();
  Vec3 torque = Vec3::Zero();
};

inline Pose operator*(const Pose& X_AB, const Pose& X_BC) noexcept {
  return {X_AB.R * X_BC.R, X_AB.p + X_AB.R * X_BC.p};
}

// The same wrench (or twist) about the same point, written in other axes: R_AB * F_B = F_A.
inline Wrench operator*(const Mat3& R, const Wrench& F) noexcept {
  return {R * F.force, R * F.torque};
}
inline Twist operator*(const Mat3& R, const Twist& V) noexcept {
  return {R * V.angular, R * V.linear};
}
inline Wrench operator+(const Wrench& a, const Wrench& b) noexcept {
  return {a.force + b.force, a.torque + b.torque};
}
inline Wrench operator-(const Wrench& a, const Wrench& b) noexcept {
  return {a.force - b.force, a.torque - b.torque};
}
inline Wrench operator*(double s, const Wrench& F) noexcept {
  return {s * F.force, s * F.torque};
}

// Unit quaternion of a rotation, with w >= 0.
inline Quat to_quat(const Mat3& R) noexcept {
  Quat q(R);
  if (q.w() < 0) q.coeffs() = -q.coeffs();
  return q;
}

// Rotation vector [rad] of R: axis times angle in [0, pi]. Accurate at small angles.
inline Vec3 rotation_vector(const Mat3& R) noexcept {
  const Quat q = to_quat(R);
  const double s = q.vec().norm();
  return s > 0 ? Vec3(q.vec() * (2 * std::atan2(s, q.w()) / s)) : Vec3::Zero();
}

// Rotation by the rotation vector r [rad] (the inverse of rotation_vector).
inline Mat3 rotation(const Vec3& r) noexcept {
  const double angle = r.norm();
  return angle > 0 ? Mat3(Eigen::AngleAxisd(angle, r / angle)) : Mat3::Identity();
}

}  // namespace farhand
