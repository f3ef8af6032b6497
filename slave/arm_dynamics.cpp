#include "slave/arm_dynamics.hpp"

#include <cmath>
#include <utility>

namespace farhand {
namespace {

// Plain scalars rather than Eigen vectors: everything below stays in registers, and the terms the
// arm's structure makes zero are never formed.
struct V3 {
  double x = 0, y = 0, z = 0;
};
V3 operator+(V3 a, V3 b) {
  return {a.x + b.x, a.y + b.y, a.z + b.z};
}
V3 operator*(double s, V3 a) {
  return {s * a.x, s * a.y, s * a.z};
}
V3 cross(V3 a, V3 b) {
  return {a.y * b.z - a.z * b.y, a.z * b.x - a.x * b.z, a.x * b.y - a.y * b.x};
}

// Quarter turns about x between the axes of B_i and those B_{i+1} turns in, i = 0..4.
constexpr std::array<int, 5> kTurn{+1, 0, +1, -1, +1};

// Vector in B_I axes, written in B_{I-1} axes: Rx(alpha) Rz(q).
template <std::size_t I>
V3 to_parent(const JointTrig& t, V3 v) {
  const double x = t.c[I] * v.x - t.s[I] * v.y, y = t.s[I] * v.x + t.c[I] * v.y;
  if constexpr (kTurn[I - 1] > 0) return {x, -v.z, y};
  if constexpr (kTurn[I - 1] < 0) return {x, v.z, -y};
  return {x, y, v.z};
}
template <std::size_t I>
V3 to_child(const JointTrig& t, V3 v) {
  V3 u = v;
  if constexpr (kTurn[I - 1] > 0) u = {v.x, v.z, -v.y};
  if constexpr (kTurn[I - 1] < 0) u = {v.x, -v.z, v.y};
  return {t.c[I] * u.x + t.s[I] * u.y, t.c[I] * u.y - t.s[I] * u.x, u.z};
}

// The origin of B_I seen from B_{I-1}. Only two offsets matter: d1 lies on the axis of joint 1, the
// others are zero.
template <std::size_t I>
V3 offset_cross(const ArmDynamics& arm, V3 f) {  // offset x f
  if constexpr (I == 2) return {0, -arm.a2 * f.z, arm.a2 * f.y};
  if constexpr (I == 4) return {-arm.d4 * f.y, arm.d4 * f.x, 0};
  return {};
}
template <std::size_t I>
constexpr bool kHasOffset = I == 2 || I == 4;

// Moment about the body's origin, and force.
struct Load {
  V3 n, f;
};

template <std::size_t I>
Load to_parent(const ArmDynamics& arm, const JointTrig& t, const Load& F) {
  Load P{to_parent<I>(t, F.n), to_parent<I>(t, F.f)};
  if constexpr (kHasOffset<I>) P.n = P.n + offset_cross<I>(arm, P.f);
  return P;
}

V3 times(const LinkInertia& I, V3 w) {
  return {I.xx * w.x + I.xy * w.y + I.xz * w.z, I.xy * w.x + I.yy * w.y + I.yz * w.z,
          I.xz * w.x + I.yz * w.y + I.zz * w.z};
}

// --- bias -----------------------------------------------------------------------------------

// Motion of a body: angular velocity and acceleration, acceleration of its origin (gravity as an
// upward acceleration of the base), with ddq = 0.
struct Motion {
  V3 w, dw, a;
};

template <std::size_t I>
Motion child(const ArmDynamics& arm, const JointTrig& t, const Motion& m, double dq) {
  V3 a = m.a;
  if constexpr (kHasOffset<I>) {
    const V3 p = I == 2 ? V3{arm.a2, 0, 0} : V3{0, 0, arm.d4};
    a = a + cross(m.dw, p) + cross(m.w, cross(m.w, p));
  }
  Motion c{to_child<I>(t, m.w), to_child<I>(t, m.dw), to_child<I>(t, a)};
  c.dw.x += c.w.y * dq;
  c.dw.y -= c.w.x * dq;
  c.w.z += dq;
  return c;
}

Load inertial_load(const LinkInertia& I, const Motion& m) {
  const V3 h{I.hx, I.hy, I.hz};
  return {times(I, m.dw) + cross(m.w, times(I, m.w)) + cross(h, m.a),
          I.mass * m.a + cross(m.dw, h) + cross(m.w, cross(m.w, h))};
}

// Fills tau[I..5] and returns the load body I puts on joint I.
template <std::size_t I>
Load bias_from(const ArmDynamics& arm, const JointTrig& t, const Vec6& dq, const Motion& m,
               double* tau) {
  Load F = inertial_load(arm.links[I], m);
  if constexpr (I < 5) {
    const Load outer = bias_from<I + 1>(arm, t, dq, child<I + 1>(arm, t, m, dq[I + 1]), tau);
    const Load P = to_parent<I + 1>(arm, t, outer);
    F = {F.n + P.n, F.f + P.f};
  }
  tau[I] = F.n.z;
  return F;
}

void bias_torques(const ArmDynamics& arm, const JointTrig& t, const Vec6& dq, double* tau) {
  const double c = t.c[0], s = t.s[0];
  const Vec3& g = arm.gravity;
  const Motion base{{0, 0, dq[0]}, {}, {-c * g.x() - s * g.y(), s * g.x() - c * g.y(), -g.z()}};
  bias_from<0>(arm, t, dq, base, tau);
}

// --- mass matrix ----------------------------------------------------------------------------

// Inertia of body I in the axes and about the origin of B_{I-1}.
template <std::size_t I>
LinkInertia to_parent(const ArmDynamics& arm, const JointTrig& t, const LinkInertia& b) {
  const double c = t.c[I], s = t.s[I];
  const V3 h = to_parent<I>(t, V3{b.hx, b.hy, b.hz});
  const double cs = c * s, cc = c * c, d = b.xx - b.yy;
  const double k = d * cs + b.xy * (cc - s * s);  // xy after Rz
  const double xx = b.yy + d * cc - 2 * b.xy * cs, yy = b.xx + b.yy - xx;
  const double xz = c * b.xz - s * b.yz, yz = s * b.xz + c * b.yz;
  LinkInertia p{b.mass, h.x, h.y, h.z, xx, yy, b.zz, k, xz, yz};
  if constexpr (kTurn[I - 1] > 0) p.yy = b.zz, p.zz = yy, p.xy = -xz, p.xz = k, p.yz = -yz;
  if constexpr (kTurn[I - 1] < 0) p.yy = b.zz, p.zz = yy, p.xy = xz, p.xz = -k, p.yz = -yz;
  if constexpr (I == 2) {  // parallel axes, offset along x
    const double e = arm.a2, m = e * b.mass, g = e * (2 * p.hx + m);
    p.yy += g, p.zz += g, p.xy -= e * p.hy, p.xz -= e * p.hz, p.hx += m;
  }
  if constexpr (I == 4) {  // offset along z
    const double e = arm.d4, m = e * b.mass, g = e * (2 * p.hz + m);
    p.xx += g, p.yy += g, p.xz -= e * p.hx, p.yz -= e * p.hy, p.hz += m;
  }
  return p;
}

LinkInertia operator+(const LinkInertia& a, const LinkInertia& b) {
  return {a.mass + b.mass, a.hx + b.hx, a.hy + b.hy, a.hz + b.hz, a.xx + b.xx,
          a.yy + b.yy,     a.zz + b.zz, a.xy + b.xy, a.xz + b.xz, a.yz + b.yz};
}

// Row by row from the tool: the load of a unit acceleration of each joint, carried to the base.
// Fills M[I][J] for J >= I, into the lower half M[J][I].
using Columns = std::array<Load, 6>;
using Matrix = std::array<std::array<double, 6>, 6>;

template <std::size_t I>
void mass_from(const ArmDynamics& arm, const JointTrig& t, const LinkInertia& composite, Columns& F,
               Matrix& M) {
  F[I] = {{composite.xz, composite.yz, composite.zz}, {-composite.hy, composite.hx, 0}};
  [&]<std::size_t... J>(std::index_sequence<J...>) {
    ((M[I + J][I] = F[I + J].n.z), ...);
    if constexpr (I > 0) ((F[I + J] = to_parent<I>(arm, t, F[I + J])), ...);
  }
  (std::make_index_sequence<6 - I>{});
  M[I][I] += arm.armature;
  if constexpr (I > 0)
    mass_from<I - 1>(arm, t, arm.links[I - 1] + to_parent<I>(arm, t, composite), F, M);
}

Matrix mass_lower(const ArmDynamics& arm, const JointTrig& t) {
  Columns F;
  Matrix M;
  mass_from<5>(arm, t, arm.links[5], F, M);
  return M;
}

// --- potential ------------------------------------------------------------------------------

V3 moment_of(const LinkInertia& l) {
  return {l.hx, l.hy, l.hz};
}

// First moment [kg m] of the whole arm about the base, S axes, from that of bodies I..5 in B_I.
template <std::size_t I>
V3 first_moment(const ArmDynamics& arm, const JointTrig& t, double mass, V3 h) {
  if constexpr (I == 0) {
    return {t.c[0] * h.x - t.s[0] * h.y, t.s[0] * h.x + t.c[0] * h.y, h.z};
  } else {
    constexpr bool kAlongZ = I == 1 || I == 4;
    const double d = I == 1 ? arm.d1 : I == 2 ? arm.a2 : I == 4 ? arm.d4 : 0;
    const V3 shift = kAlongZ ? V3{0, 0, d * mass} : V3{d * mass, 0, 0};
    const LinkInertia& l = arm.links[I - 1];
    return first_moment<I - 1>(arm, t, mass + l.mass, to_parent<I>(t, h) + shift + moment_of(l));
  }
}

// --- solve ----------------------------------------------------------------------------------

// M x = b by M = L^T D L from the last row up; only the lower half of M is read. The bounds are
// constants, so the compiler unrolls all of it.
Vec6 solve(Matrix& M, std::array<double, 6>& b) {
  std::array<double, 6> inverse, x;
#pragma GCC unroll 6
  for (std::size_t k = 5; k < 6; --k) {
    inverse[k] = 1 / M[k][k];
#pragma GCC unroll 6
    for (std::size_t i = 0; i < k; ++i) {
      const double l = M[k][i] * inverse[k];
      b[i] -= l * b[k];
#pragma GCC unroll 6
      for (std::size_t j = 0; j <= i; ++j) M[i][j] -= l * M[k][j];
    }
  }
#pragma GCC unroll 6
  for (std::size_t k = 0; k < 6; ++k) {
    double r = b[k];
#pragma GCC unroll 6
    for (std::size_t i = 0; i < k; ++i) r -= M[k][i] * x[i];
    x[k] = r * inverse[k];
  }
  return Vec6::Map(x.data());
}

}  // namespace

ArmDynamics make_arm_dynamics(const ArmModel& m) noexcept {
  ArmDynamics arm{.d1 = m.lengths.d1,
                  .a2 = m.lengths.a2,
                  .d4 = m.lengths.d4,
                  .d6 = m.lengths.d6,
                  .armature = m.armature,
                  .gravity = m.gravity};
  for (std::size_t i = 0; i < 6; ++i) {
    const LinkModel& l = m.links[i];
    const Vec3 h = l.mass * l.com;
    Mat3 I = l.mass * (l.com.squaredNorm() * Mat3::Identity() - l.com * l.com.transpose());
    I.diagonal() += l.inertia;
    arm.links[i] = {l.mass,  h.x(),   h.y(),   h.z(),   I(0, 0),
                    I(1, 1), I(2, 2), I(0, 1), I(0, 2), I(1, 2)};
  }
  return arm;
}

ArmFrames arm_frames(const ArmDynamics& arm, const JointTrig& t) noexcept {
  ArmFrames out;
  const std::array<Vec3, 6> offset{Vec3::Zero(), Vec3(0, 0, arm.d1), Vec3(arm.a2, 0, 0),
                                   Vec3::Zero(), Vec3(0, 0, arm.d4), Vec3::Zero()};
  Vec3 x = Vec3::UnitX(), y = Vec3::UnitY(), z = Vec3::UnitZ(), p = Vec3::Zero();
  for (std::size_t i = 0; i < 6; ++i) {
    p += offset[i].x() * x + offset[i].z() * z;
    if (i > 0 && kTurn[i - 1] != 0) {
      const Vec3 old = y;
      y = kTurn[i - 1] * z;
      z = -kTurn[i - 1] * old;
    }
    const Vec3 turned = t.c[i] * x + t.s[i] * y;
    y = t.c[i] * y - t.s[i] * x;
    x = turned;
    out.axis[i] = z;
    out.point[i] = p;
  }
  out.X_SE.R << x, y, z;
  out.X_SE.p = p + arm.d6 * z;
  return out;
}

Twist tool_twist(const ArmFrames& frames, const Vec6& dq) noexcept {
  Twist V;
  for (std::size_t i = 0; i < 6; ++i) {
    const Vec3 w = dq[static_cast<Eigen::Index>(i)] * frames.axis[i];
    V.angular += w;
    V.linear += w.cross(frames.X_SE.p - frames.point[i]);
  }
  return V;
}

Vec6 joint_torques(const ArmFrames& frames, const Wrench& F) noexcept {
  Vec6 tau;
  for (std::size_t i = 0; i < 6; ++i) {
    const Vec3 moment = F.torque + (frames.X_SE.p - frames.point[i]).cross(F.force);
    tau[static_cast<Eigen::Index>(i)] = frames.axis[i].dot(moment);
  }
  return tau;
}

Mat6 mass_matrix(const ArmDynamics& arm, const Vec6& q) noexcept {
  const Matrix lower = mass_lower(arm, joint_trig(q));
  Mat6 M;
  for (std::size_t i = 0; i < 6; ++i)
    for (std::size_t j = 0; j <= i; ++j)
      M(static_cast<Eigen::Index>(i), static_cast<Eigen::Index>(j)) =
          M(static_cast<Eigen::Index>(j), static_cast<Eigen::Index>(i)) = lower[i][j];
  return M;
}

Vec6 bias(const ArmDynamics& arm, const Vec6& q, const Vec6& dq) noexcept {
  Vec6 tau;
  bias_torques(arm, joint_trig(q), dq, tau.data());
  return tau;
}

Vec6 gravity_torques(const ArmDynamics& arm, const Vec6& q) noexcept {
  return bias(arm, q, Vec6::Zero());
}

Vec6 forward_dynamics(const ArmDynamics& arm, const JointTrig& trig, const Vec6& dq,
                      const Vec6& tau) noexcept {
  std::array<double, 6> b;
  bias_torques(arm, trig, dq, b.data());
  for (std::size_t i = 0; i < 6; ++i) b[i] = tau[static_cast<Eigen::Index>(i)] - b[i];
  Matrix M = mass_lower(arm, trig);
  return solve(M, b);
}

Vec6 forward_dynamics(const ArmDynamics& arm, const Vec6& q, const Vec6& dq, const Vec6& tau,
                      const Wrench& F_E_S_external) noexcept {
  const JointTrig trig = joint_trig(q);
  return forward_dynamics(arm, trig, dq,
                          tau + joint_torques(arm_frames(arm, trig), F_E_S_external));
}

double energy(const ArmDynamics& arm, const Vec6& q, const Vec6& dq) noexcept {
  const V3 h = first_moment<5>(arm, joint_trig(q), arm.links[5].mass, moment_of(arm.links[5]));
  return 0.5 * dq.dot(mass_matrix(arm, q) * dq) - arm.gravity.dot(Vec3(h.x, h.y, h.z));
}

}  // namespace farhand
