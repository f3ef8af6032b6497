// The closed forms both parallel handles are built from: a planar two-bar leg, the meeting point of
// three spheres, and the map between three bars and their motors. Nothing here calls a
// trigonometric function.
#pragma once

#include <algorithm>
#include <cmath>

#include "common/geometry.hpp"
#include "common/status.hpp"

namespace farhand {

// The triangle of a motor arm, a second bar, and the line from the motor to the leg end at distance
// `reach`. All from products of its four side sums, so full accuracy is kept up to the workspace
// edge, where an arccosine loses half the digits.
//   shoulder (arm to line):   cos = shoulder_cos / (4 arm reach), sin = sine / (4 arm reach)
//   knee (arm to second bar): cos = knee_cos / (4 arm bar),       sin = sine / (4 arm bar)
// Both angles lie in [0, pi]. Status too_far, too_close; only `status` is meaningful then.
struct TwoBar {
  Status status = Status::no_solution;
  double reach = 0;
  double sine = 0;  // 8 times the triangle's area
  double shoulder_cos = 0;
  double knee_cos = 0;
};

inline TwoBar two_bar(double arm, double bar, double reach) noexcept {
  const double sum = arm + bar + reach, stretch = arm + bar - reach;
  const double inner = reach - (arm - bar), outer = reach + (arm - bar);
  if (!(stretch >= 0)) return {.status = Status::too_far};
  if (!(inner >= 0 && outer >= 0 && reach > 0)) return {.status = Status::too_close};
  return {.status = Status::ok,
          .reach = reach,
          .sine = 2 * std::sqrt((stretch * sum) * (inner * outer)),
          .shoulder_cos = outer * sum - stretch * inner,
          .knee_cos = inner * outer - stretch * sum};
}

// Direction of the arm for a leg end at (x, y), hypot(x, y) = reach; its length is 4 arm reach^2.
// bend +1: the arm lies clockwise from the line to the leg end; -1: on the other side.
struct Direction {
  double x = 0, y = 0;
  double angle() const noexcept { return std::atan2(y, x); }
};
inline Direction arm_direction(const TwoBar& t, double x, double y, double bend) noexcept {
  const double s = bend * t.sine;
  return {x * t.shoulder_cos + y * s, y * t.shoulder_cos - x * s};
}

// Where three spheres meet: foot + lift and foot - lift, foot in the plane of the centres, lift
// along (S2 - S1) x (S3 - S1). Status no_solution (lift = 0, foot still valid) when they do not
// meet, singular when the centres lie on a line. Exact also where eliminations divide by zero
// (twin-delta publication eq. 12-16; reference section 5.4).
struct SphereMeeting {
  Status status = Status::no_solution;
  Vec3 foot = Vec3::Zero();
  Vec3 lift = Vec3::Zero();
};

// Columns of S: the centres [m]; radii [m].
inline SphereMeeting meet(const Mat3& S, const Vec3& radii) noexcept {
  const Vec3 P = S.col(1) - S.col(0), Q = S.col(2) - S.col(0), N = P.cross(Q);
  const double nn = N.squaredNorm(), r2 = radii[0] * radii[0];
  if (!(nn > 0)) return {.status = Status::singular};
  const double alpha = (r2 - radii[1] * radii[1] + P.squaredNorm()) / 2;
  const double beta = (r2 - radii[2] * radii[2] + Q.squaredNorm()) / 2;
  const Vec3 W = (alpha * Q.cross(N) + beta * N.cross(P)) / nn;
  const double height2 = r2 - W.squaredNorm();
  const bool meets = height2 >= 0;
  return {.status = meets ? Status::ok : Status::no_solution,
          .foot = S.col(0) + W,
          .lift = meets ? Vec3(N * std::sqrt(height2 / nn)) : Vec3::Zero()};
}

// A 3x3 matrix A with the cross products of its rows, to solve with A and its transpose by Cramer's
// rule: as accurate as a factorisation at this size, whatever the scale of the rows. det = 0 gives
// no solution: the caller looks first.
struct ThreeRows {
  Mat3 A = Mat3::Identity();
  Mat3 crosses = Mat3::Identity();  // column i: row j x row k
  double det = 1;
};
inline ThreeRows three_rows(const Mat3& A) noexcept {
  const Vec3 a = A.row(0), b = A.row(1), c = A.row(2);
  ThreeRows out{.A = A};
  out.crosses << b.cross(c), c.cross(a), a.cross(b);
  out.det = a.dot(out.crosses.col(0));
  return out;
}
inline Vec3 solve(const ThreeRows& m, const Vec3& b) noexcept {
  return (1 / m.det) * (m.crosses * b);
}
inline Vec3 solve_transposed(const ThreeRows& m, const Vec3& b) noexcept {
  return (1 / m.det) * (m.crosses.transpose() * b);
}

// Three bars carry the platform, each pushed by a motor: unit bar directions n_i (rows of bars.A)
// and the lever with which motor i acts along its bar [m]. With platform velocity v and force f:
//   theta_dot_i = n_i . v / lever_i          f = sum n_i tau_i / lever_i
// Status singular: bars coplanar or a lever gone; the functions then answer zero, the safe torque.
struct BarMap {
  Status status = Status::singular;
  ThreeRows bars{};
  Vec3 lever = Vec3::Zero();
};
inline BarMap make_bar_map(const Mat3& bars, const Vec3& lever) noexcept {
  constexpr double kNothing = 1e-12;  // of a determinant of unit rows, or metres: below, rounding
  BarMap m{.bars = three_rows(bars), .lever = lever};
  const bool regular = std::abs(m.bars.det) > kNothing && lever.cwiseAbs().minCoeff() > kNothing;
  m.status = regular ? Status::ok : Status::singular;
  return m;
}
inline Vec3 torque(const BarMap& m, const Vec3& f) noexcept {
  if (m.status != Status::ok) return Vec3::Zero();
  return m.lever.cwiseProduct(solve_transposed(m.bars, f));
}
inline Vec3 force(const BarMap& m, const Vec3& tau) noexcept {
  if (m.status != Status::ok) return Vec3::Zero();
  return m.bars.A.transpose() * tau.cwiseQuotient(m.lever);
}
inline Vec3 theta_rates(const BarMap& m, const Vec3& v) noexcept {
  if (m.status != Status::ok) return Vec3::Zero();
  return (m.bars.A * v).cwiseQuotient(m.lever);
}
inline Vec3 velocity(const BarMap& m, const Vec3& rates) noexcept {
  if (m.status != Status::ok) return Vec3::Zero();
  return solve(m.bars, m.lever.cwiseProduct(rates));
}

// The end of a handle's accepted workspace, made felt before it is there: the force grows from zero
// at `margin` before an edge to `max_force` at it.
struct WorkspaceEdge {
  double margin = 0.006;  // [m] > 0
  double max_force = 8;   // [N]
};
// Push against one edge, along the gradient of its measure. spare: by how much the measure exceeds
// what is accepted; slope: length of its gradient [1/m]. To first order spare / slope metres are
// left, which is what the force goes by. slope = 0: none.
inline double edge_push(const WorkspaceEdge& e, double spare, double slope) noexcept {
  const double near = e.margin * slope - spare;
  return near > 0 ? e.max_force * std::min(1.0, near / (e.margin * slope)) : 0;
}
// The same as a vector.
inline Vec3 edge_push(const WorkspaceEdge& e, double spare, const Vec3& gradient) noexcept {
  const double slope = gradient.norm();
  if (!(slope > 0)) return Vec3::Zero();
  return (edge_push(e, spare, slope) / slope) * gradient;
}

}  // namespace farhand
