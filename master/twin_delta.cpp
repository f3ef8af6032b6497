#include "master/twin_delta.hpp"

#include <cmath>

#include "common/atan2.hpp"
#include "common/sincos.hpp"

namespace farhand {
namespace {

constexpr int kHalf = 3;  // legs of either structure
constexpr std::array<double, kHalf> kBend{1, -1, 1};
constexpr double kMinDet = 0.15;                     // reference section 5.6
constexpr double kMinLever = 0.02;                   // [m]
constexpr double kSinMaxTilt = 0.99619469809174553;  // sin 85 deg
constexpr double kAlongX = 1e-9;                     // hypot(uy, uz) below which x_h is noise

// A half-structure's own axes to and from those of M: a half turn about X for the lower one.
Vec3 turn(int half, const Vec3& x) noexcept {
  return half == 0 ? x : Vec3(x.x(), -x.y(), -x.z());
}
Vec3 to_half(const TwinDeltaGeometry& g, int half, const Vec3& p_ME) noexcept {
  return turn(half, p_ME) - Vec3(0, 0, g.a12);
}
Vec3 from_half(const TwinDeltaGeometry& g, int half, const Vec3& e) noexcept {
  return turn(half, e + Vec3(0, 0, g.a12));
}

// The legs move in planes: the side ones in x, y, the middle one in x, -z. Half axes to and from
// leg axes (in plane, in plane, out of plane).
Vec3 to_leg(int leg, const Vec3& x) noexcept {
  return leg < 2 ? x : Vec3(x.x(), -x.z(), x.y());
}
Vec3 from_leg(int leg, const Vec3& x) noexcept {
  return leg < 2 ? x : Vec3(x.x(), x.z(), -x.y());
}
// Added to the end point, in leg axes, it becomes the end of the leg seen from its motor (eq.
// 5-10).
Vec3 offset(const TwinDeltaGeometry& g, int leg) noexcept {
  if (leg == 2) return {g.b - g.d, g.c - g.h, 0};
  return {0, leg == 0 ? g.a - g.d : g.d - g.a, g.h};
}
Vec3 reach_vector(const TwinDeltaGeometry& g, int leg, const Vec3& e) noexcept {
  return to_leg(leg, e) + offset(g, leg);
}

struct Leg {
  TwoBar bars;
  Direction arm;
  double in_plane = 0;  // of the forearm
};

Leg close(const TwinDeltaGeometry& g, int leg, const Vec3& reach) noexcept {
  Leg out;
  const double m2 = (g.L2[leg] - reach.z()) * (g.L2[leg] + reach.z());
  if (!(m2 >= 0)) {
    out.bars.status = Status::lateral_limit;
    return out;
  }
  out.in_plane = std::sqrt(m2);
  const double R = std::sqrt(reach.x() * reach.x() + reach.y() * reach.y());
  out.bars = two_bar(g.L1[leg], out.in_plane, R);
  out.arm = arm_direction(out.bars, reach.x(), reach.y(), kBend[leg]);
  return out;
}

bool finite(const TwinDeltaPose& pose) noexcept {
  return pose.p_MH.allFinite() && pose.axis.allFinite() && std::isfinite(pose.length);
}

std::array<Vec3, 2> ends_in_halves(const TwinDeltaGeometry& g, const TwinDeltaPose& x) noexcept {
  const Vec3 half = x.length / 2 * x.axis;
  return {to_half(g, 0, x.p_MH + half), to_half(g, 1, x.p_MH - half)};
}

// Meeting point of one half's forearms, in its own axes.
SphereMeeting meet_forearms(const TwinDeltaGeometry& g, const double* cos1,
                            const double* sin1) noexcept {
  Mat3 centres;
  for (int i = 0; i < kHalf; ++i)
    centres.col(i) = from_leg(i, Vec3(g.L1[i] * cos1[i], g.L1[i] * sin1[i], 0) - offset(g, i));
  return meet(centres, Vec3(g.L2[0], g.L2[1], g.L2[2]));
}

BarMap half_map(const TwinDeltaGeometry& g, const Vec3& e, const double* cos1,
                const double* sin1) noexcept {
  Mat3 forearms;
  Vec3 lever;
  for (int i = 0; i < kHalf; ++i) {
    const Vec3 knee(g.L1[i] * cos1[i], g.L1[i] * sin1[i], 0);
    const Vec3 forearm = (reach_vector(g, i, e) - knee) / g.L2[i];
    forearms.row(i) = from_leg(i, forearm);
    lever[i] = knee.x() * forearm.y() - knee.y() * forearm.x();
  }
  return make_bar_map(forearms, lever);
}

double lossless_k(const TwinDeltaGeometry& g) noexcept {
  return (g.l_max - g.l_min) / (4 * std::numbers::pi);
}

TwinDeltaJacobian assemble(const TwinDeltaGeometry& g, const std::array<Vec3, 2>& e,
                           const Vec6& cos1, const Vec6& sin1, const Mat3& R_MG,
                           double length) noexcept {
  TwinDeltaJacobian J{.R_MG = R_MG, .length = length, .k_force = g.k, .k_velocity = lossless_k(g)};
  for (int half = 0; half < 2; ++half)
    J.half[half] = half_map(g, e[half], &cos1[kHalf * half], &sin1[kHalf * half]);
  const bool regular = J.half[0].status == Status::ok && J.half[1].status == Status::ok;
  J.status = regular && length > 0 ? Status::ok : Status::singular;
  return J;
}

bool usable(const BarMap& m) noexcept {
  if (m.bars.det < kMinDet) return false;
  for (int i = 0; i < kHalf; ++i)
    if (kBend[i] * m.lever[i] < kMinLever) return false;
  return true;
}

bool finite(const Wrench& F) noexcept {
  return F.force.allFinite() && F.torque.allFinite();
}

// The knee turns by d theta1 = n.de / lever as the end moves by de, and the forearm's direction n
// by what is left: dn = (de - k' d theta1) / L2, k' the knee's own direction of motion.
Vec3 half_edge_force(const TwinDeltaGeometry& g, const BarMap& m, const double* cos1,
                     const double* sin1, const WorkspaceEdge& edge) noexcept {
  Vec3 f = Vec3::Zero(), det_slope = Vec3::Zero();
  for (int i = 0; i < kHalf; ++i) {
    const Vec3 knee = from_leg(i, g.L1[i] * Vec3(cos1[i], sin1[i], 0));
    const Vec3 ahead = from_leg(i, g.L1[i] * Vec3(-sin1[i], cos1[i], 0));
    const Vec3 n = m.bars.A.row(i), turn = n / m.lever[i], cross = m.bars.crosses.col(i);
    det_slope += (cross - cross.dot(ahead) * turn) / g.L2[i];
    const Vec3 lever_slope = (ahead - g.L1[i] * g.L1[i] * turn) / g.L2[i] - n.dot(knee) * turn;
    f += edge_push(edge, kBend[i] * m.lever[i] - kMinLever, Vec3(kBend[i] * lever_slope));
  }
  return f + edge_push(edge, m.bars.det - kMinDet, det_slope);
}

// On E1; E2 gets the opposite. Length and tilt change twice as fast as either end moves.
Vec3 pair_edge_force(const TwinDeltaGeometry& g, const TwinDeltaJacobian& J,
                     const WorkspaceEdge& edge) noexcept {
  const Vec3 u = J.R_MG.col(2);
  const double tilt = u.x(), side = tilt < 0 ? -1 : 1;
  const Vec3 longer = 2 * u, steeper = (2 * side / J.length) * (Vec3::UnitX() - tilt * u);
  return 0.5 * (edge_push(edge, J.length - g.l_min, longer) +
                edge_push(edge, g.l_max - J.length, Vec3(-longer)) +
                edge_push(edge, kSinMaxTilt - side * tilt, Vec3(-steeper)));
}

}  // namespace

TwinDeltaInverse inverse(const TwinDeltaGeometry& g, const TwinDeltaPose& pose) noexcept {
  TwinDeltaInverse out;
  if (!finite(pose)) return out;
  out.status = Status::ok;
  const std::array<Vec3, 2> e = ends_in_halves(g, pose);
  for (int k = 0; k < 2 * kHalf; ++k) {
    const int i = k % kHalf;
    const Vec3 reach = reach_vector(g, i, e[k / kHalf]);
    const Leg leg = close(g, i, reach);
    out.legs[k] = leg.bars.status;
    if (out.status == Status::ok) out.status = leg.bars.status;
    if (leg.bars.status != Status::ok) continue;
    out.theta1[k] = leg.arm.angle();
    out.theta2[k] = kBend[i] * std::atan2(leg.bars.sine, leg.bars.knee_cos);
    out.theta3[k] = std::atan2(reach.z(), leg.in_plane);
    out.theta1_other[k] = arm_direction(leg.bars, reach.x(), reach.y(), -kBend[i]).angle();
  }
  return out;
}

TwinDeltaMotorAngles motor_angles(const TwinDeltaGeometry& g, const TwinDeltaPose& pose) noexcept {
  if (!finite(pose)) return {};
  const std::array<Vec3, 2> e = ends_in_halves(g, pose);
  Vec6 x, y;  // the arms' directions
  for (int k = 0; k < 2 * kHalf; ++k) {
    const int i = k % kHalf;
    const Leg leg = close(g, i, reach_vector(g, i, e[k / kHalf]));
    if (leg.bars.status != Status::ok) return {.status = leg.bars.status};
    x[k] = leg.arm.x, y[k] = leg.arm.y;
  }
  TwinDeltaMotorAngles out{.status = Status::ok};
  atan2<2 * kHalf>(y.data(), x.data(), out.theta1.data());
  return out;
}

void solve_forward(const TwinDeltaGeometry& g, const Vec6& theta1, TwinDeltaForward& out) noexcept {
  out.status = Status::not_finite;
  if (!theta1.allFinite()) return;
  const SinCos<2 * kHalf> t = sincos<2 * kHalf>(theta1.data());
  out.cos1 = Vec6::Map(t.c.data());
  out.sin1 = Vec6::Map(t.s.data());
  const SphereMeeting upper = meet_forearms(g, out.cos1.data(), out.sin1.data());
  const SphereMeeting lower = meet_forearms(g, out.cos1.data() + kHalf, out.sin1.data() + kHalf);
  out.status = upper.status != Status::ok ? upper.status : lower.status;
  if (out.status != Status::ok) return;
  out.p_ME1 = from_half(g, 0, upper.foot + upper.lift);
  out.p_ME2 = from_half(g, 1, lower.foot + lower.lift);
  const Vec3 span = out.p_ME1 - out.p_ME2;
  const double length = span.norm();
  if (length > 0)
    out.pose = {.p_MH = (out.p_ME1 + out.p_ME2) / 2, .axis = span / length, .length = length};
  else
    out.status = Status::singular;
}

TwinDeltaForward forward(const TwinDeltaGeometry& g, const Vec6& theta1) noexcept {
  TwinDeltaForward out;
  solve_forward(g, theta1, out);
  return out;
}

TwinDeltaPassiveAngles passive_angles(const TwinDeltaGeometry& g,
                                      const TwinDeltaForward& at) noexcept {
  TwinDeltaPassiveAngles out;
  if (at.status != Status::ok) return out;
  const std::array<Vec3, 2> e{to_half(g, 0, at.p_ME1), to_half(g, 1, at.p_ME2)};
  for (int k = 0; k < 2 * kHalf; ++k) {
    const int i = k % kHalf;
    const double c = at.cos1[k], s = at.sin1[k];
    const Vec3 forearm = reach_vector(g, i, e[k / kHalf]) - g.L1[i] * Vec3(c, s, 0);
    out.theta2[k] =
        std::atan2(c * forearm.y() - s * forearm.x(), c * forearm.x() + s * forearm.y());
    out.theta3[k] = std::atan2(forearm.z(), std::hypot(forearm.x(), forearm.y()));
  }
  return out;
}

double twist_angle(const TwinDeltaGeometry& g, double length) noexcept {
  return (length - (g.l_min + g.l_max) / 2) / (2 * lossless_k(g));
}
double twist_length(const TwinDeltaGeometry& g, double gamma_c) noexcept {
  return (g.l_min + g.l_max) / 2 + 2 * lossless_k(g) * gamma_c;
}

Mat3 handle_axes(const Vec3& u, const Vec3& previous_x_h) noexcept {
  const double n = std::sqrt(u.y() * u.y() + u.z() * u.z());
  Vec3 x, y;
  if (n > kAlongX) {
    const double c = u.z() / n, s = u.y() / n;
    x = {n, -u.x() * s, -u.x() * c};
    y = {0, c, -s};
  } else {
    x = previous_x_h - previous_x_h.dot(u) * u;
    const double length = x.norm();
    x = length > 0.1 ? Vec3(x / length) : Vec3(0, 0, -1);
    y = u.cross(x);
  }
  Mat3 R_MG;
  R_MG << x, y, u;
  return R_MG;
}

Mat3 handle_rotation(const TwinDeltaGeometry& g, const Mat3& R_MG, double length) noexcept {
  const double gamma = twist_angle(g, length), c = std::cos(gamma), s = std::sin(gamma);
  Mat3 R_MH;
  R_MH << c * R_MG.col(0) + s * R_MG.col(1), c * R_MG.col(1) - s * R_MG.col(0), R_MG.col(2);
  return R_MH;
}

HandleAngles handle_angles(const Vec3& u) noexcept {
  return {.alpha = std::atan2(u.y(), u.z()),
          .beta = std::atan2(u.x(), u.z()),
          .alpha_e = std::atan2(-u.y(), u.z()),
          .beta_e = std::atan2(u.x(), std::hypot(u.y(), u.z()))};
}

Vec3 axis_from_angles(double alpha, double beta) noexcept {
  return Vec3(std::tan(beta), std::tan(alpha), 1).normalized();
}

TwinDeltaJacobian jacobian(const TwinDeltaGeometry& g, const TwinDeltaPose& pose,
                           const Mat3& R_MG) noexcept {
  if (!finite(pose) || !R_MG.allFinite()) return {};
  const std::array<Vec3, 2> e = ends_in_halves(g, pose);
  Vec6 cos1, sin1;
  for (int k = 0; k < 2 * kHalf; ++k) {
    const int i = k % kHalf;
    const Leg leg = close(g, i, reach_vector(g, i, e[k / kHalf]));
    if (leg.bars.status != Status::ok) return {.status = leg.bars.status};
    const double scale = 1 / (4 * g.L1[i] * leg.bars.reach * leg.bars.reach);
    cos1[k] = leg.arm.x * scale;
    sin1[k] = leg.arm.y * scale;
  }
  return assemble(g, e, cos1, sin1, R_MG, pose.length);
}

TwinDeltaJacobian jacobian(const TwinDeltaGeometry& g, const TwinDeltaForward& at,
                           const Mat3& R_MG) noexcept {
  if (at.status != Status::ok) return {.status = at.status};
  if (!R_MG.allFinite()) return {};
  return assemble(g, {to_half(g, 0, at.p_ME1), to_half(g, 1, at.p_ME2)}, at.cos1, at.sin1, R_MG,
                  at.pose.length);
}

bool accepted(const TwinDeltaGeometry& g, const TwinDeltaJacobian& J) noexcept {
  return J.status == Status::ok && usable(J.half[0]) && usable(J.half[1]) && J.length >= g.l_min &&
         J.length <= g.l_max && std::abs(J.R_MG(0, 2)) <= kSinMaxTilt;
}

// Seen in handle axes, what the ends share is the force and what they differ by is the torque:
// F = G1 + G2, (My, -Mx) = l/2 (G1 - G2) across the axis, Mz = k (G1 - G2) along it.
EndForces end_forces(const TwinDeltaJacobian& J, const Wrench& F) noexcept {
  if (J.status != Status::ok || !finite(F)) return {};
  const double r = 2 / J.length;
  const Vec3 difference(r * F.torque.y(), -r * F.torque.x(), F.torque.z() / J.k_force);
  return {J.R_MG * ((F.force + difference) / 2), turn(1, J.R_MG * ((F.force - difference) / 2))};
}

Wrench wrench(const TwinDeltaJacobian& J, const EndForces& f) noexcept {
  if (J.status != Status::ok || !f.f_E1_M.allFinite() || !f.f_E2_A2.allFinite()) return {};
  const Vec3 G1 = J.R_MG.transpose() * f.f_E1_M, G2 = J.R_MG.transpose() * turn(1, f.f_E2_A2);
  const Vec3 difference = G1 - G2;
  const double r = J.length / 2;
  return {.force = G1 + G2,
          .torque = {-r * difference.y(), r * difference.x(), J.k_force * difference.z()}};
}

Wrench edge_wrench(const TwinDeltaGeometry& g, const TwinDeltaForward& at,
                   const TwinDeltaJacobian& J, const WorkspaceEdge& edge) noexcept {
  if (J.status != Status::ok || at.status != Status::ok) return {};
  EndForces f{half_edge_force(g, J.half[0], at.cos1.data(), at.sin1.data(), edge),
              half_edge_force(g, J.half[1], at.cos1.data() + kHalf, at.sin1.data() + kHalf, edge)};
  const Vec3 apart = pair_edge_force(g, J, edge);
  f.f_E1_M += apart;
  f.f_E2_A2 -= turn(1, apart);
  return wrench(J, f);
}

Vec6 torque(const TwinDeltaJacobian& J, const Wrench& F_G) noexcept {
  const EndForces f = end_forces(J, F_G);
  Vec6 tau;
  tau << torque(J.half[0], f.f_E1_M), torque(J.half[1], f.f_E2_A2);
  return tau;
}

Wrench wrench(const TwinDeltaJacobian& J, const Vec6& tau) noexcept {
  if (!tau.allFinite()) return {};
  return wrench(J, EndForces{force(J.half[0], tau.head<3>()), force(J.half[1], tau.tail<3>())});
}

Vec6 theta_rates(const TwinDeltaJacobian& J, const Twist& V) noexcept {
  if (J.status != Status::ok || !V.angular.allFinite() || !V.linear.allFinite())
    return Vec6::Zero();
  const double r = J.length / 2;
  const Vec3 end(r * V.angular.y(), -r * V.angular.x(), J.k_velocity * V.angular.z());
  Vec6 rates;
  rates << theta_rates(J.half[0], J.R_MG * (V.linear + end)),
      theta_rates(J.half[1], turn(1, J.R_MG * (V.linear - end)));
  return rates;
}

Twist velocity(const TwinDeltaJacobian& J, const Vec6& theta_rates) noexcept {
  if (J.status != Status::ok || !theta_rates.allFinite()) return {};
  const Vec3 v1 = J.R_MG.transpose() * velocity(J.half[0], theta_rates.head<3>());
  const Vec3 v2 = J.R_MG.transpose() * turn(1, velocity(J.half[1], theta_rates.tail<3>()));
  const Vec3 end = (v1 - v2) / 2;
  const double r = 2 / J.length;
  return {.angular = {-r * end.y(), r * end.x(), end.z() / J.k_velocity}, .linear = (v1 + v2) / 2};
}

}  // namespace farhand
