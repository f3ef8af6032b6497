#include "slave/arm.hpp"

#include <algorithm>
#include <cmath>

#include "common/sincos.hpp"

namespace farhand {
namespace {

constexpr double kSingular = 1e-12;

struct Angle {
  double c, s;
};

// A vector in the axes of the arm's vertical plane: outward from axis 1, along axis 2, up. Plain
// doubles, so that they stay in registers until a result is stored.
struct Local {
  double r, t, z;
};
Local mix(double a, const Local& x, double b, const Local& y) noexcept {
  return {a * x.r + b * y.r, a * x.t + b * y.t, a * x.z + b * y.z};
}
Vec3 in_S(const Angle& j1, const Local& v) noexcept {
  return {j1.c * v.r + j1.s * v.t, j1.s * v.r - j1.c * v.t, v.z};
}

// What pose and Jacobian are both made of: unit vectors, and points counted from the shoulder.
struct Chain {
  Chain(const ArmGeometry& g, const Vec6& q) noexcept : Chain(g, sincos<6>(q.data())) {}
  Chain(const ArmGeometry& g, const SinCos<6>& t) noexcept
      : j1{t.c[0], t.s[0]}, j3{t.c[2], t.s[2]}, j5{t.c[4], t.s[4]}, j6{t.c[5], t.s[5]} {
    const Angle j2{t.c[1], t.s[1]}, j4{t.c[3], t.s[3]};
    const double c23 = j2.c * j3.c - j2.s * j3.s, s23 = j2.s * j3.c + j2.c * j3.s;
    axis4 = {s23, 0, -c23};
    axis5 = {-j4.s * c23, j4.c, -j4.s * s23};
    const Local x4{j4.c * c23, j4.s, j4.c * s23};
    swing = mix(j5.c, x4, -j5.s, axis4);
    axis6 = mix(j5.s, x4, j5.c, axis4);
    elbow = {g.a2 * j2.c, 0, g.a2 * j2.s};
    wrist = mix(1, elbow, g.d4, axis4);
    tool = mix(1, wrist, g.d6, axis6);
  }

  Angle j1, j3, j5, j6;
  Local axis4, axis5, axis6;
  Local swing;  // where joint 5 swings axis 6 to
  Local elbow, wrist, tool;
};

Vec3 point(const ArmGeometry& g, const Chain& k, const Local& p) noexcept {
  return in_S(k.j1, p) + Vec3(0, 0, g.d1);
}

Pose tool_pose(const ArmGeometry& g, const Chain& k) noexcept {
  Pose X_SE;
  X_SE.R.col(0) = in_S(k.j1, mix(k.j6.c, k.swing, k.j6.s, k.axis5));
  X_SE.R.col(1) = in_S(k.j1, mix(k.j6.c, k.axis5, -k.j6.s, k.swing));
  X_SE.R.col(2) = in_S(k.j1, k.axis6);
  X_SE.p = point(g, k, k.tool);
  return X_SE;
}

ArmJacobian jacobian(const ArmGeometry& g, const Chain& k) noexcept {
  const double d6s5 = g.d6 * k.j5.s;
  const Local& p = k.tool;
  using Block = Eigen::Matrix<double, 3, 6>;
  ArmJacobian J{Block(), Block()};  // every column follows: not zeroed first
  J.linear.col(0) = in_S(k.j1, {p.t, -p.r, 0});
  J.linear.col(1) = in_S(k.j1, {-p.z, 0, p.r});
  J.linear.col(2) = in_S(k.j1, {k.elbow.z - p.z, 0, p.r - k.elbow.r});
  J.linear.col(3) = in_S(k.j1, {d6s5 * k.axis5.r, d6s5 * k.axis5.t, d6s5 * k.axis5.z});
  J.linear.col(4) = in_S(k.j1, {g.d6 * k.swing.r, g.d6 * k.swing.t, g.d6 * k.swing.z});
  J.linear.col(5).setZero();
  J.angular.col(0) = Vec3::UnitZ();
  J.angular.col(1) = in_S(k.j1, {0, 1, 0});
  J.angular.col(2) = J.angular.col(1);
  J.angular.col(3) = in_S(k.j1, k.axis4);
  J.angular.col(4) = in_S(k.j1, k.axis5);
  J.angular.col(5) = in_S(k.j1, k.axis6);
  return J;
}

}  // namespace

Pose forward(const ArmGeometry& g, const Vec6& q) noexcept {
  return tool_pose(g, Chain(g, q));
}

ArmJacobian jacobian(const ArmGeometry& g, const Vec6& q) noexcept {
  return jacobian(g, Chain(g, q));
}

ArmKinematics kinematics(const ArmGeometry& g, const Vec6& q) noexcept {
  if (!q.allFinite()) return {};
  const Chain k(g, q);
  return {.status = Status::ok,
          .X_SE = tool_pose(g, k),
          .J = jacobian(g, k),
          .singularity = {.wrist = std::abs(k.j5.s),
                          .elbow = std::abs(k.j3.c),
                          .shoulder = std::abs(k.wrist.r)},
          .p_S_elbow = point(g, k, k.elbow),
          .p_S_wrist = point(g, k, k.wrist),
          .r = k.wrist.r,
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
