#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>

#include "slave/arm.hpp"

namespace farhand {
namespace {

constexpr double kPi = std::numbers::pi;
constexpr double kEdge = 1e-12;              // [m] beyond the reach that counts as the edge
constexpr double kRotationTolerance = 1e-9;  // on the six conditions of a rotation matrix
// Below these the direction of the wrist centre about axis 1, or of axis 6 about axis 4, is nothing
// but the rounding of the pose: following it would turn joints at random for no gain in accuracy.
constexpr double kOnAxis = 5e-16;         // [m]
constexpr double kInLine = 2e-15;         // [rad]
constexpr double kLimitRounding = 1e-12;  // [rad]
constexpr double kJustBeyondQuarter = kPi / 2 * (1 + std::numeric_limits<double>::epsilon());

constexpr double kAboutAsNear =
    1.1;  // past the wrist singularity two rows may be a quarter turn off

// atan2 in (-pi, pi]: a negative zero above the negative half-axis does not count as below it.
double angle(double y, double x) noexcept {
  const double q = std::atan2(y, x);
  return q > -kPi ? q : kPi;
}
// q + pi and pi + q alike, in (-pi, pi] for q in [-pi, pi].
double opposite(double q) noexcept {
  return q > 0 ? q - kPi : q + kPi;
}
double wrapped(double q) noexcept {
  const double w = std::remainder(q, 2 * kPi);
  return w > -kPi ? w : kPi;
}
double unwrapped(double q, double near) noexcept {
  const double turns = (near - q) / (2 * kPi);
  return std::abs(turns) <= 0.5 ? q : q + 2 * kPi * std::rint(turns);
}

bool is_rotation(const Mat3& R) noexcept {
  const Vec3 x = R.col(0), y = R.col(1), residual = x.cross(y) - R.col(2);
  const double worst = std::max({std::abs(x.squaredNorm() - 1), std::abs(y.squaredNorm() - 1),
                                 std::abs(x.dot(y)), residual.cwiseAbs().maxCoeff()});
  return worst <= kRotationTolerance;
}

Status check(const ArmGeometry& g, const Pose& X, const Vec6& q_previous) noexcept {
  if (!X.p.allFinite() || !X.R.allFinite() || !q_previous.allFinite() ||
      !std::isfinite(g.d1 + g.a2 + g.d4 + g.d6))
    return Status::not_finite;
  return g.a2 > 0 && g.d4 > 0 && is_rotation(X.R) ? Status::ok : Status::no_solution;
}

// The wrist centre: radius from axis 1, height above the shoulder; and what it says about q3.
struct WristCentre {
  Status status = Status::ok;
  double miss = 0;
  double x = 0, y = 0;
  double r = 0, z = 0;
  double sin_q3 = 0, cos_q3 = 0;  // of the elbow +1
};

WristCentre wrist_centre(const ArmGeometry& g, const Pose& X, const Vec6& q_previous) noexcept {
  WristCentre w{.status = check(g, X, q_previous)};
  if (w.status != Status::ok) return w;
  const Vec3 p = X.p - g.d6 * X.R.col(2);
  w.x = p.x(), w.y = p.y(), w.z = p.z() - g.d1;
  const double r2 = w.x * w.x + w.y * w.y;
  const double rho2 = r2 + w.z * w.z, rho = std::sqrt(rho2);
  const double sum = g.a2 + g.d4, difference = g.a2 - g.d4;
  const double beyond = rho - sum, within = std::abs(difference) - rho;
  if (beyond > kEdge) {
    w.status = Status::too_far;
    w.miss = std::isfinite(rho) ? beyond : std::hypot(w.x, w.y, w.z) - sum;
  } else if (within > kEdge) {
    w.status = Status::too_close;
    w.miss = within;
  }
  w.r = r2 > kOnAxis * kOnAxis ? std::sqrt(r2) : 0;
  // The product keeps the digits that 1 - sin^2 would lose at the edge of the reach. Both are then
  // put on the unit circle, so that what follows is consistent to rounding (Newton, one step).
  const double product = (sum - rho) * (sum + rho) * (rho - difference) * (rho + difference);
  const double scale = 1 / (2 * g.a2 * g.d4);
  const double c = std::sqrt(std::max(product, 0.0)) * scale;
  const double s = std::clamp((rho2 - g.a2 * g.a2 - g.d4 * g.d4) * scale, -1.0, 1.0);
  const double norm = 1.5 - 0.5 * (s * s + c * c);
  w.sin_q3 = s * norm, w.cos_q3 = c * norm;
  return w;
}

struct Shoulder {
  double q1, c1, s1;
  double r;  // signed
};
Shoulder shoulder(const WristCentre& w, int sign, double q1_previous) noexcept {
  if (w.r == 0) return {q1_previous, std::cos(q1_previous), std::sin(q1_previous), 0};
  const double x = sign * w.x, y = sign * w.y;
  return {angle(y, x), x / w.r, y / w.r, sign * w.r};
}

// A stretched or folded elbow stays on its own side by the last bit, so that the next sample, which
// has only q to go by, finds the branch again.
double elbow_angle(const WristCentre& w, int sign) noexcept {
  const double q3 = std::atan2(w.sin_q3, sign * w.cos_q3);
  return sign > 0 ? q3 : std::copysign(std::max(std::abs(q3), kJustBeyondQuarter), q3);
}

struct Plane {
  double q2, c23, s23;
};
Plane plane(const ArmGeometry& g, const WristCentre& w, double r, int elbow,
            double q2_previous) noexcept {
  const double s3 = w.sin_q3, c3 = elbow * w.cos_q3;
  const double A = g.a2 + g.d4 * s3, B = g.d4 * c3;
  double x = r * A - w.z * B, y = w.z * A + r * B;
  double n2 = x * x + y * y;
  if (!(n2 > 0)) {  // a2 = d4 folded onto the shoulder: any q2
    x = std::cos(q2_previous), y = std::sin(q2_previous), n2 = 1;
  }
  const double n = 1 / std::sqrt(n2), c2 = x * n, s2 = y * n;
  return {angle(y, x), c2 * c3 - s2 * s3, s2 * c3 + c2 * s3};
}

struct Wrist {
  double q4, q5, q6;
  double h;  // |sin q5|; 0: axes 4 and 6 in line
};

// Q = R03^T R = Rz(q4) Ry(q5) Rz(q6), the wrist +1. q6 comes from row 2 of Rz(-q4) Q, which has
// unit length everywhere.
Wrist wrist(const Mat3& R, const Shoulder& a, const Plane& b, double q4_previous) noexcept {
  const Vec3 radial = a.c1 * R.row(0) + a.s1 * R.row(1);
  const Vec3 Q2 = a.s1 * R.row(0) - a.c1 * R.row(1);
  const Vec3 Q1 = b.c23 * radial + b.s23 * R.row(2).transpose();
  const double Q33 = b.s23 * radial[2] - b.c23 * R(2, 2);
  const double h2 = Q1[2] * Q1[2] + Q2[2] * Q2[2];
  const bool in_line = !(h2 > kInLine * kInLine);
  const double h = in_line ? 0 : std::sqrt(h2);
  const double q4 = in_line ? q4_previous : angle(Q2[2], Q1[2]);
  const double c4 = in_line ? std::cos(q4) : Q1[2] / h, s4 = in_line ? std::sin(q4) : Q2[2] / h;
  return {q4, std::atan2(h, Q33), angle(c4 * Q2[0] - s4 * Q1[0], c4 * Q2[1] - s4 * Q1[1]), h};
}

Wrist flipped(const Wrist& w) noexcept {
  return w.h > 0 ? Wrist{opposite(w.q4), -w.q5, opposite(w.q6), w.h} : w;
}
// The same tool carried by the arm turned by pi about axis 4 (shoulder and elbow changed).
Wrist carried_behind(const Wrist& w) noexcept {
  return w.h > 0 ? Wrist{opposite(w.q4), w.q5, w.q6, w.h} : Wrist{w.q4, w.q5, opposite(w.q6), w.h};
}

struct ArmSide {
  int shoulder, elbow;
};
// The shoulder and elbow q stands in.
ArmSide side_of(const ArmGeometry& g, const WristCentre& w, const Vec6& q) noexcept {
  const double r = g.a2 * std::cos(q[1]) + g.d4 * std::sin(q[1] + q[2]);
  const double forward = std::abs(r) > kOnAxis ? r : w.x * std::cos(q[0]) + w.y * std::sin(q[0]);
  return {forward >= 0 ? 1 : -1, std::cos(q[2]) >= 0 ? 1 : -1};
}

// Unwraps q next to the previous one; the time the wrist joints need to get there.
double continue_wrist(Vec6& q, const Wrist& w, const Vec6& previous, const Vec6& speed) noexcept {
  q.tail<3>() << unwrapped(w.q4, previous[3]), unwrapped(w.q5, previous[4]),
      unwrapped(w.q6, previous[5]);
  return ((q - previous).tail<3>().array().abs() / speed.tail<3>().array()).maxCoeff();
}

bool within(const JointLimits& limits, const Vec6& q) noexcept {
  return ((q - limits.lower).array() >= -kLimitRounding).all() &&
         ((limits.upper - q).array() >= -kLimitRounding).all();
}

}  // namespace

// By symmetry the arm behind, with the other elbow, repeats the one in front: ten atan2 in all.
ArmInverse inverse_all(const ArmGeometry& g, const Pose& X_SE, const Vec6& q_previous) noexcept {
  const WristCentre w = wrist_centre(g, X_SE, q_previous);
  ArmInverse out{.status = w.status, .miss = w.miss};
  if (w.status != Status::ok) return out;
  const Shoulder front = shoulder(w, 1, wrapped(q_previous[0]));
  const double q3_up = elbow_angle(w, 1), q3_down = elbow_angle(w, -1);
  const auto put = [&](ArmBranch b, double q1, double q2, const Wrist& k) {
    const double q3 = b.elbow > 0 ? q3_up : q3_down;
    out.rows[static_cast<std::size_t>(row_of(b))] << q1, q2, q3, k.q4, k.q5, k.q6;
  };
  for (const int e : {1, -1}) {
    const Plane p = plane(g, w, front.r, e, wrapped(q_previous[1]));
    const Wrist k = wrist(X_SE.R, front, p, wrapped(q_previous[3]));
    put({1, e, 1}, front.q1, p.q2, k);
    put({1, e, -1}, front.q1, p.q2, flipped(k));
    const bool on_axis = w.r == 0;
    const double q1 = on_axis ? front.q1 : opposite(front.q1);
    const double q2 = on_axis ? p.q2 : opposite(-p.q2);
    const Wrist behind = on_axis ? k : carried_behind(k);
    const int elbow = on_axis ? e : -e;
    put({-1, elbow, 1}, q1, q2, behind);
    put({-1, elbow, -1}, q1, q2, flipped(behind));
  }
  return out;
}

ArmNearest inverse(const ArmGeometry& g, const JointLimits& limits, const Pose& X_SE,
                   const Vec6& q_previous) noexcept {
  const WristCentre w = wrist_centre(g, X_SE, q_previous);
  ArmNearest out{.status = w.status, .miss = w.miss};
  if (q_previous.allFinite()) out.q = q_previous;
  if (w.status != Status::ok) return out;

  const ArmSide side = side_of(g, w, q_previous);
  const Shoulder a = shoulder(w, side.shoulder, q_previous[0]);
  const Plane p = plane(g, w, a.r, side.elbow, q_previous[1]);
  const Wrist k = wrist(X_SE.R, a, p, q_previous[3]);
  Vec6 q, other;
  q << unwrapped(a.q1, q_previous[0]), unwrapped(p.q2, q_previous[1]),
      unwrapped(elbow_angle(w, side.elbow), q_previous[2]), 0, 0, 0;
  other = q;
  double time = continue_wrist(q, k, q_previous, limits.speed);
  double other_time = continue_wrist(other, flipped(k), q_previous, limits.speed);
  if (other_time < time) q.swap(other), std::swap(time, other_time);
  if (other_time < kAboutAsNear * time && !within(limits, q) && within(limits, other)) q = other;

  const bool negative = q[4] < 0 || (q[4] == 0 && q_previous[4] < 0);
  out.branch = {side.shoulder, side.elbow, negative ? -1 : 1};
  out.singularity = {.wrist = k.h, .elbow = w.cos_q3, .shoulder = w.r};
  out.status = within(limits, q) ? Status::ok : Status::out_of_limits;
  if (out.status == Status::ok) out.q = q.cwiseMax(limits.lower).cwiseMin(limits.upper);
  return out;
}

}  // namespace farhand
