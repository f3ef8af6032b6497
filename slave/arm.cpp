#include "slave/arm.hpp"

#include <algorithm>
#include <cmath>

namespace farhand {
namespace {

constexpr double kSingular = 1e-12;

struct Angle {
  explicit Angle(double q) noexcept : c(std::cos(q)), s(std::sin(q)) {}
  double c, s;
};

// What pose and Jacobian are both made of. Elbow and wrist lie in the vertical plane of the arm,
// (r, z) counted from the shoulder; the vectors are unit vectors in S axes.
struct Chain {
  Chain(const ArmGeometry& g, const Vec6& q) noexcept;

  Angle j1, j2, j3, j4, j5, j6;
  double elbow_r, elbow_z, wrist_r, wrist_z;
  Vec3 axis4;  // along the forearm
  Vec3 axis5;
  Vec3 across;  // completes axis5 and the tool axis: d6 times it is what joint 5 does to the tool
  Pose X_SE;
};

Chain::Chain(const ArmGeometry& g, const Vec6& q) noexcept
    : j1(q[0]), j2(q[1]), j3(q[2]), j4(q[3]), j5(q[4]), j6(q[5]) {
  const double c23 = j2.c * j3.c - j2.s * j3.s, s23 = j2.s * j3.c + j2.c * j3.s;
  elbow_r = g.a2 * j2.c;
  elbow_z = g.a2 * j2.s;
  wrist_r = elbow_r + g.d4 * s23;
  wrist_z = elbow_z - g.d4 * c23;

  const Vec3 x3(j1.c * c23, j1.s * c23, s23), y3(j1.s, -j1.c, 0);
  axis4 = Vec3(j1.c * s23, j1.s * s23, -c23);
  axis5 = j4.c * y3 - j4.s * x3;
  const Vec3 x4 = j4.c * x3 + j4.s * y3;
  across = j5.c * x4 - j5.s * axis4;
  const Vec3 tool = j5.s * x4 + j5.c * axis4;
  X_SE.R << j6.c * across + j6.s * axis5, j6.c * axis5 - j6.s * across, tool;
  X_SE.p = Vec3(j1.c * wrist_r, j1.s * wrist_r, g.d1 + wrist_z) + g.d6 * tool;
}

// The velocity of a point (r, z) of the arm's plane when it turns about the shoulder or elbow.
Vec3 pitch(const Angle& j1, double r, double z) noexcept {
  return {-j1.c * z, -j1.s * z, r};
}

ArmJacobian jacobian(const ArmGeometry& g, const Chain& k) noexcept {
  const Vec3& p = k.X_SE.p;
  const double r = k.j1.c * p.x() + k.j1.s * p.y(), z = p.z() - g.d1;
  const Vec3 axis2(k.j1.s, -k.j1.c, 0);
  ArmJacobian J;
  J.linear.col(0) << -p.y(), p.x(), 0;
  J.linear.col(1) = pitch(k.j1, r, z);
  J.linear.col(2) = pitch(k.j1, r - k.elbow_r, z - k.elbow_z);
  J.linear.col(3) = g.d6 * k.j5.s * k.axis5;
  J.linear.col(4) = g.d6 * k.across;
  J.angular.col(0) = Vec3::UnitZ();
  J.angular.col(1) = axis2;
  J.angular.col(2) = axis2;
  J.angular.col(3) = k.axis4;
  J.angular.col(4) = k.axis5;
  J.angular.col(5) = k.X_SE.R.col(2);
  return J;
}

}  // namespace

Pose forward(const ArmGeometry& geometry, const Vec6& q) noexcept {
  return Chain(geometry, q).X_SE;
}

ArmKinematics kinematics(const ArmGeometry& g, const Vec6& q) noexcept {
  if (!q.allFinite()) return {};
  const Chain k(g, q);
  return {.status = Status::ok,
          .X_SE = k.X_SE,
          .J = jacobian(g, k),
          .singularity = {.wrist = std::abs(k.j5.s),
                          .elbow = std::abs(k.j3.c),
                          .shoulder = std::abs(k.wrist_r)},
          .p_S_elbow = {k.j1.c * k.elbow_r, k.j1.s * k.elbow_r, g.d1 + k.elbow_z},
          .p_S_wrist = {k.j1.c * k.wrist_r, k.j1.s * k.wrist_r, g.d1 + k.wrist_z},
          .r = k.wrist_r,
          .cos_q3 = k.j3.c,
          .sin_q5 = k.j5.s};
}

Vec6 joint_torques(const ArmJacobian& J, const Wrench& F_E_S) noexcept {
  return J.linear.transpose() * F_E_S.force + J.angular.transpose() * F_E_S.torque;
}

Twist tool_twist(const ArmJacobian& J, const Vec6& dq) noexcept {
  return {J.angular * dq, J.linear * dq};
}

JointRates joint_rates(const ArmGeometry& g, const ArmKinematics& at, const Twist& V) noexcept {
  if (at.status != Status::ok || !V.linear.allFinite() || !V.angular.allFinite()) return {};
  const ArmSingularity& m = at.singularity;
  if (std::min({m.wrist, m.elbow, m.shoulder}) < kSingular) return {.status = Status::singular};

  const auto axis = [&](int joint) { return at.J.angular.col(joint - 1); };
  const Vec3 v_wrist = V.linear - V.angular.cross(at.X_SE.p - at.p_S_wrist);
  const Vec3 upper_arm = at.p_S_elbow - Vec3(0, 0, g.d1);
  // Joint 1 alone moves the wrist centre out of the arm's plane, against axis 2. In the plane, the
  // forearm's turning does not change the velocity along the forearm, nor the upper arm's along it.
  const double dq1 = -v_wrist.dot(axis(2)) / at.r;
  const double dq2 = -v_wrist.dot(axis(4)) / (g.a2 * at.cos_q3);
  const double dq23 = v_wrist.dot(upper_arm) / (g.a2 * g.d4 * at.cos_q3);
  const Vec3 w_wrist = V.angular - dq1 * axis(1) - dq23 * axis(2);
  JointRates out{.status = Status::ok};
  out.dq << dq1, dq2, dq23 - dq2, w_wrist.dot(axis(6).cross(axis(5))) / at.sin_q5,
      w_wrist.dot(axis(5)), w_wrist.dot(axis(5).cross(axis(4))) / at.sin_q5;
  return out;
}

}  // namespace farhand
