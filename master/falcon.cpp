#include "master/falcon.hpp"

#include <algorithm>
#include <cmath>

#include "common/atan2.hpp"
#include "common/sincos.hpp"

namespace farhand {
namespace {

constexpr int kLegs = 3;
constexpr int kMaxIterations = 8;
constexpr double kMaxStep = 0.030;  // [m]
constexpr double kLastStep = 1e-9;  // [m]; convergence is quadratic, what remains is rounding
// After a step of L < kSmallStep the bars are as good as at its end: a step of l with them leaves
// l^2 / L or less, and another makes that l / L times as much, until it is below kRounding.
constexpr double kSmallStep = 5e-6;  // [m]
constexpr double kRounding = 1e-17;  // [m]
constexpr int kMaxChords = 3;        // near a singularity rounding alone may exceed that for ever
constexpr double kMinDetN = 0.1;     // reference section 2.4
constexpr double kMinAbsSin = 0.1;

Vec3 to_leg(const FalconGeometry& g, int i, const Vec3& p) noexcept {
  return {g.cos_phi[i] * p.x() + g.sin_phi[i] * p.y(), g.cos_phi[i] * p.y() - g.sin_phi[i] * p.x(),
          p.z()};
}
Vec3 from_leg(const FalconGeometry& g, int i, const Vec3& uvw) noexcept {
  return {g.cos_phi[i] * uvw.x() - g.sin_phi[i] * uvw.y(),
          g.sin_phi[i] * uvw.x() + g.cos_phi[i] * uvw.y(), uvw.z()};
}

// The leg end seen from the motor: (A, v + f, w).
Vec3 reach_vector(const FalconGeometry& g, int i, const Vec3& p) noexcept {
  return to_leg(g, i, p) + Vec3(g.c - g.r, g.f - g.s, 0);
}

struct Leg {
  TwoBar bars;
  Direction arm;
  double rho = 0, cos3 = 0, sin3 = 0;
};

Leg close(const FalconGeometry& g, const Vec3& reach) noexcept {
  Leg leg;
  leg.cos3 = reach.y() / g.b;
  const double sin2 = (1 - leg.cos3) * (1 + leg.cos3);
  if (!(sin2 >= 0)) {
    leg.bars.status = Status::lateral_limit;
    return leg;
  }
  leg.sin3 = std::sqrt(sin2);
  leg.rho = g.d + g.e + g.b * leg.sin3;
  const double D = std::sqrt(reach.x() * reach.x() + reach.z() * reach.z());
  leg.bars = two_bar(g.a, leg.rho, D);
  leg.arm = arm_direction(leg.bars, reach.x(), reach.z(), 1);
  return leg;
}

FalconLeg leg_angles(const FalconGeometry& g, const Vec3& reach) noexcept {
  const Leg leg = close(g, reach);
  if (leg.bars.status != Status::ok) return {.status = leg.bars.status};
  const double scale = 1 / (4 * leg.bars.reach * leg.bars.reach);
  return {.status = Status::ok,
          .theta1 = leg.arm.angle(),
          .theta2 = std::atan2(reach.z() - leg.arm.y * scale, reach.x() - leg.arm.x * scale),
          .theta3 = std::atan2(leg.sin3, leg.cos3),
          .theta1_other = arm_direction(leg.bars, reach.x(), reach.z(), -1).angle()};
}

// From the knee to the leg end in the leg frame, and what follows from it.
struct Forearm {
  double u = 0, v = 0, w = 0;
  double rho = 0;      // its length in the leg plane
  double outward = 0;  // rho sin(t2 - t1), > 0 on the outward branch

  Forearm(const FalconGeometry& g, const Vec3& reach, double cos1, double sin1) noexcept
      : u(reach.x() - g.a * cos1), v(reach.y()), w(reach.z() - g.a * sin1) {
    rho = std::sqrt(u * u + w * w);
    outward = cos1 * w - sin1 * u;
  }
  // Along the bar, in the base frame; as long as the bar once the loop closes.
  Vec3 bar(const FalconGeometry& g, int i) const noexcept {
    const double in_plane = 1 - (g.d + g.e) / rho;
    return from_leg(g, i, {in_plane * u, v, in_plane * w});
  }
};

struct Newton {
  ThreeRows bars{};
  Vec3 step = Vec3::Zero();
  bool working = false;  // the assembly with knees outward and det_n < 0
};

// Half of what the bar's squared length lacks.
double shortfall(const FalconGeometry& g, const Forearm& f) noexcept {
  const double in_plane = f.rho - (g.d + g.e);
  return (g.b * g.b - (in_plane * in_plane + f.v * f.v)) / 2;
}

Newton newton(const FalconGeometry& g, const FalconForward& at) noexcept {
  Mat3 bars;
  Vec3 missing;
  bool outward = true;
  for (int i = 0; i < kLegs; ++i) {
    const Forearm f(g, reach_vector(g, i, at.p_MH), at.cos1[i], at.sin1[i]);
    bars.row(i) = f.bar(g, i);
    missing[i] = shortfall(g, f);
    outward = outward && f.outward > 0 && f.rho > g.d + g.e;
  }
  Newton out{.bars = three_rows(bars)};
  out.step = solve(out.bars, missing);
  out.working = outward && out.bars.det < 0;
  return out;
}

// The next step with the bars of the one before.
Vec3 chord(const FalconGeometry& g, const FalconForward& at, const ThreeRows& bars) noexcept {
  Vec3 missing;
  for (int i = 0; i < kLegs; ++i)
    missing[i] = shortfall(g, {g, reach_vector(g, i, at.p_MH), at.cos1[i], at.sin1[i]});
  return solve(bars, missing);
}

FalconForward search(const FalconGeometry& g, FalconForward at) noexcept {
  for (at.iterations = 1; at.iterations <= kMaxIterations; ++at.iterations) {
    Newton n = newton(g, at);
    double length = n.step.norm();
    if (!std::isfinite(length)) break;
    if (length > kMaxStep) n.step *= kMaxStep / length;
    at.p_MH += n.step;
    if (length >= kLastStep && length < kSmallStep && n.working) {
      const double with_bars_of = length;
      for (int k = 0; k < kMaxChords; ++k) {
        const Vec3 step = chord(g, at, n.bars);
        at.p_MH += step;
        length = step.norm();
        if (length >= kLastStep || length * length <= kRounding * with_bars_of) break;
      }
      ++at.iterations;
    }
    if (length >= kLastStep) continue;
    if (!n.working) break;
    at.status = Status::ok;
    return at;
  }
  return {.status = Status::no_solution};
}

FalconForward arms(const Vec3& theta1) noexcept {
  FalconForward at;
  if (!theta1.allFinite()) return at;
  at.status = Status::no_solution;
  const SinCos<kLegs> t = sincos<kLegs>(theta1.data());
  at.cos1 = Vec3::Map(t.c.data());
  at.sin1 = Vec3::Map(t.s.data());
  return at;
}

FalconForward cold_search(const FalconGeometry& g, FalconForward at) noexcept {
  Mat3 centres;
  for (int i = 0; i < kLegs; ++i)
    centres.col(i) = from_leg(g, i, {g.r - g.c + g.a * at.cos1[i], g.s - g.f, g.a * at.sin1[i]});
  const SphereMeeting start = meet(centres, Vec3::Constant(g.b + g.d + g.e));
  if (start.status == Status::singular) return at;
  at.p_MH = start.foot + (start.lift.z() > 0 ? 1 : -1) * start.lift;
  return search(g, at);
}

FalconJacobian from_arms(const FalconGeometry& g, const Vec3& p, const Vec3& cos1,
                         const Vec3& sin1) noexcept {
  Mat3 bars;
  Vec3 lever, knee;
  for (int i = 0; i < kLegs; ++i) {
    const Forearm f(g, reach_vector(g, i, p), cos1[i], sin1[i]);
    bars.row(i) = f.bar(g, i) / g.b;
    knee[i] = f.outward / f.rho;
    lever[i] = g.a * (f.rho - (g.d + g.e)) / g.b * knee[i];
  }
  FalconJacobian J{.map = make_bar_map(bars, lever)};
  J.status = J.map.status;
  J.det_n = J.map.bars.det;
  J.min_abs_sin = knee.cwiseAbs().minCoeff();
  return J;
}

// How measures of one leg change as the grip moves. The forearm (u, v, w) follows the grip, less
// what the arm turns: d theta1 = n.dp / lever, and the knee goes with it.
struct LegSlopes {
  Vec3 bar;   // of bar . weight, the weight being given
  Vec3 sine;  // of sin(t2 - t1)
};
LegSlopes leg_slopes(const FalconGeometry& g, int i, const FalconForward& at, const BarMap& m,
                     const Vec3& weight) noexcept {
  const double c1 = at.cos1[i], s1 = at.sin1[i], h = g.d + g.e;
  const Forearm f(g, reach_vector(g, i, at.p_MH), c1, s1);
  const double rho3 = f.rho * f.rho * f.rho, in_plane = 1 - h / f.rho;
  const Vec3 along(f.u, 0, f.w), knee(-g.a * s1, 0, g.a * c1);
  const Vec3 turn = to_leg(g, i, m.bars.A.row(i)) / m.lever[i];
  const Vec3 k = to_leg(g, i, weight);
  const Vec3 bar =
      Vec3(in_plane * k.x(), k.y(), in_plane * k.z()) + (h * along.dot(k) / rho3) * along;
  const Vec3 sine = Vec3(-s1, 0, c1) / f.rho - (f.outward / rho3) * along;
  const double sine_by_arm = -(s1 * f.w + c1 * f.u) / f.rho;
  return {from_leg(g, i, bar - bar.dot(knee) * turn),
          from_leg(g, i, sine + (sine_by_arm - sine.dot(knee)) * turn)};
}

}  // namespace

Vec3 theta1_from_counts(const FalconGeometry& g, const Eigen::Vector3i& counts) noexcept {
  return Vec3::Constant(g.angle_offset) + theta1_quantum(g) * counts.cast<double>();
}

Eigen::Vector3i counts_from_theta1(const FalconGeometry& g, const Vec3& theta1) noexcept {
  Eigen::Vector3i counts;
  for (int i = 0; i < kLegs; ++i) {
    const double n = std::round((theta1[i] - g.angle_offset) / theta1_quantum(g));
    counts[i] = std::isfinite(n) ? static_cast<int>(std::clamp(n, -32768.0, 32767.0)) : 0;
  }
  return counts;
}

FalconLeg leg_inverse(const FalconGeometry& g, const Vec3& uvw) noexcept {
  if (!uvw.allFinite()) return {};
  return leg_angles(g, uvw + Vec3(g.c, g.f, 0));
}

FalconInverse inverse(const FalconGeometry& g, const Vec3& p_MH) noexcept {
  FalconInverse out;
  if (!p_MH.allFinite()) return out;
  out.status = Status::ok;
  for (int i = 0; i < kLegs; ++i) {
    const FalconLeg leg = leg_angles(g, reach_vector(g, i, p_MH));
    out.legs[i] = leg.status;
    if (out.status == Status::ok) out.status = leg.status;
    out.theta1[i] = leg.theta1;
    out.theta2[i] = leg.theta2;
    out.theta3[i] = leg.theta3;
    out.theta1_other[i] = leg.theta1_other;
  }
  return out;
}

FalconMotorAngles motor_angles(const FalconGeometry& g, const Vec3& p_MH) noexcept {
  if (!p_MH.allFinite()) return {};
  Vec3 x, y;  // the arms' directions
  for (int i = 0; i < kLegs; ++i) {
    const Leg leg = close(g, reach_vector(g, i, p_MH));
    if (leg.bars.status != Status::ok) return {.status = leg.bars.status};
    x[i] = leg.arm.x, y[i] = leg.arm.y;
  }
  FalconMotorAngles out{.status = Status::ok};
  atan2<kLegs>(y.data(), x.data(), out.theta1.data());
  return out;
}

FalconForward forward(const FalconGeometry& g, const Vec3& theta1) noexcept {
  const FalconForward at = arms(theta1);
  return at.status == Status::not_finite ? at : cold_search(g, at);
}

FalconForward forward(const FalconGeometry& g, const Vec3& theta1,
                      const Vec3& p_previous) noexcept {
  const FalconForward at = arms(theta1);
  if (at.status == Status::not_finite) return at;
  FalconForward warm = at;
  warm.p_MH = p_previous;
  warm = search(g, warm);
  return warm.status == Status::ok ? warm : cold_search(g, at);
}

FalconJacobian jacobian(const FalconGeometry& g, const Vec3& p_MH) noexcept {
  if (!p_MH.allFinite()) return {};
  Vec3 cos1, sin1;
  for (int i = 0; i < kLegs; ++i) {
    const Leg leg = close(g, reach_vector(g, i, p_MH));
    if (leg.bars.status != Status::ok) return {.status = leg.bars.status};
    const double scale = 1 / (4 * g.a * leg.bars.reach * leg.bars.reach);
    cos1[i] = leg.arm.x * scale;
    sin1[i] = leg.arm.y * scale;
  }
  return from_arms(g, p_MH, cos1, sin1);
}

FalconJacobian jacobian(const FalconGeometry& g, const FalconForward& at) noexcept {
  if (at.status != Status::ok) return {.status = at.status};
  return from_arms(g, at.p_MH, at.cos1, at.sin1);
}

bool accepted(const FalconGeometry&, const FalconJacobian& J) noexcept {
  return J.status == Status::ok && J.det_n <= -kMinDetN && J.min_abs_sin >= kMinAbsSin;
}

Vec3 edge_force(const FalconGeometry& g, const FalconForward& at, const FalconJacobian& J,
                const WorkspaceEdge& edge) noexcept {
  Vec3 f = Vec3::Zero(), det_slope = Vec3::Zero();
  if (J.status != Status::ok || at.status != Status::ok) return f;
  for (int i = 0; i < kLegs; ++i) {
    const LegSlopes slopes = leg_slopes(g, i, at, J.map, J.map.bars.crosses.col(i) / g.b);
    const Forearm forearm(g, reach_vector(g, i, at.p_MH), at.cos1[i], at.sin1[i]);
    det_slope += slopes.bar;
    f += edge_push(edge, forearm.outward / forearm.rho - kMinAbsSin, slopes.sine);
  }
  return f + edge_push(edge, -J.det_n - kMinDetN, Vec3(-det_slope));
}

Mat3 inverse_jacobian(const FalconJacobian& J) noexcept {
  if (J.status != Status::ok) return Mat3::Zero();
  return J.map.lever.cwiseInverse().asDiagonal() * J.map.bars.A;
}

Vec3 torque(const FalconJacobian& J, const Vec3& f_H_M) noexcept {
  return f_H_M.allFinite() ? torque(J.map, f_H_M) : Vec3::Zero();
}
Vec3 force(const FalconJacobian& J, const Vec3& tau) noexcept {
  return tau.allFinite() ? force(J.map, tau) : Vec3::Zero();
}
Vec3 theta_rates(const FalconJacobian& J, const Vec3& v_MH) noexcept {
  return v_MH.allFinite() ? theta_rates(J.map, v_MH) : Vec3::Zero();
}
Vec3 velocity(const FalconJacobian& J, const Vec3& theta_rates) noexcept {
  return theta_rates.allFinite() ? velocity(J.map, theta_rates) : Vec3::Zero();
}

}  // namespace farhand
