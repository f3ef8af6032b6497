#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>

#include "common/atan2.hpp"
#include "common/sincos.hpp"
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
constexpr double kPassing = 0.025;        // [m] from axis 1, many ticks of fast motion
constexpr double kLimitRounding = 1e-12;  // [rad]
constexpr double kJustBeyondQuarter = kPi / 2 * (1 + std::numeric_limits<double>::epsilon());

constexpr double kAboutAsNear =
    1.1;  // past the wrist singularity two rows may be a quarter turn off

// q + pi and pi + q alike, in (-pi, pi] for q in [-pi, pi].
double opposite(double q) noexcept {
  return q + (q > 0 ? -kPi : kPi);
}
double wrapped(double q) noexcept {
  const double w = std::remainder(q, 2 * kPi);
  return w > -kPi ? w : kPi;
}
double unwrapped(double q, double near) noexcept {
  constexpr double kRound = 0x1.8p52;  // what is added to it is rounded to whole turns
  const double turns = (near - q) * (1 / (2 * kPi));
  return q + 2 * kPi * ((turns + kRound) - kRound);
}

bool is_rotation(const Mat3& R) noexcept {
  const Vec3 x = R.col(0), y = R.col(1), residual = x.cross(y) - R.col(2);
  const double worst = std::max({std::abs(x.squaredNorm() - 1), std::abs(y.squaredNorm() - 1),
                                 std::abs(x.dot(y)), residual.cwiseAbs().maxCoeff()});
  return worst <= kRotationTolerance;
}

Status check(const ArmGeometry& g, const Pose& X, const Vec6& q_previous) noexcept {
  // A sum is finite when its terms are, but for those of 1e308.
  const double sum = X.p.sum() + X.R.sum() + q_previous.sum() + (g.d1 + g.a2 + g.d4 + g.d6);
  if (!std::isfinite(sum) && !(X.p.allFinite() && X.R.allFinite() && q_previous.allFinite() &&
                               std::isfinite(g.d1 + g.a2 + g.d4 + g.d6)))
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

// Joints are kept as directions until all are known: their arctangents are then taken together.
struct Shoulder {
  double x, y;    // the direction of joint 1
  double c1, s1;  // its cosine and sine
  double r;       // signed
};
Shoulder shoulder(const WristCentre& w, int sign, double q1_previous) noexcept {
  if (w.r == 0) {
    const SinCos<1> t = sincos<1>(&q1_previous);
    return {t.c[0], t.s[0], t.c[0], t.s[0], 0};
  }
  const double x = sign * w.x, y = sign * w.y;
  return {x, y, x / w.r, y / w.r, sign * w.r};
}

// A stretched or folded elbow stays on its own side by the last bit, so that the next sample, which
// has only q to go by, finds the branch again.
double on_own_side(double q3, int elbow) noexcept {
  return elbow > 0 ? q3 : std::copysign(std::max(std::abs(q3), kJustBeyondQuarter), q3);
}

struct Direction {
  Lanes y, x;
};

// Upper arm and forearm with the elbow on the sides `elbow`, a sign in either lane.
struct ArmPlane {
  Direction j2;
  Lanes c23, s23;
};
ArmPlane plane(const ArmGeometry& g, const WristCentre& w, double r, Lanes elbow,
               double q2_previous) noexcept {
  const double s3 = w.sin_q3, A = g.a2 + g.d4 * s3;
  const Lanes c3 = w.cos_q3 * elbow, B = g.d4 * c3;
  Lanes x = r * A - w.z * B, y = w.z * A + r * B;
  Lanes n2 = x * x + y * y;
  if (!(std::min(n2[0], n2[1]) > 0)) {  // a2 = d4 folded onto the shoulder: any q2
    const SinCos<1> t = sincos<1>(&q2_previous);
    x = lanes(t.c[0]), y = lanes(t.s[0]), n2 = lanes(1);
  }
  const Lanes n = 1 / sqrt(n2), c2 = x * n, s2 = y * n;
  return {{y, x}, c2 * c3 - s2 * s3, s2 * c3 + c2 * s3};
}

// Q = R03^T R = Rz(q4) Ry(q5) Rz(q6), the wrist +1. q6 comes from row 2 of Rz(-q4) Q, which has
// unit length everywhere; here it is as long as h = |sin q5|.
struct WristDirections {
  Direction j4, j5, j6;
  Lanes h;  // 0: axes 4 and 6 in line
};
WristDirections wrist_directions(const Mat3& R, const Shoulder& a, const ArmPlane& b,
                                 double q4_previous) noexcept {
  const Vec3 radial = a.c1 * R.row(0) + a.s1 * R.row(1);
  const Vec3 Q2 = a.s1 * R.row(0) - a.c1 * R.row(1);
  const Lanes Q11 = b.c23 * radial[0] + b.s23 * R(2, 0);
  const Lanes Q12 = b.c23 * radial[1] + b.s23 * R(2, 1);
  const Lanes Q13 = b.c23 * radial[2] + b.s23 * R(2, 2);
  const Lanes Q33 = b.s23 * radial[2] - b.c23 * R(2, 2);
  const Lanes h2 = Q13 * Q13 + Q2[2] * Q2[2];
  const LaneBits apart = less(lanes(kInLine * kInLine), h2);
  Lanes c4 = Q13, s4 = lanes(Q2[2]), h = sqrt(h2);
  if ((apart[0] & apart[1]) == 0) {
    const SinCos<1> t = sincos<1>(&q4_previous);
    c4 = select(apart, c4, lanes(t.c[0])), s4 = select(apart, s4, lanes(t.s[0]));
    h = select(apart, h, lanes(0));
  }
  return {{s4, c4}, {h, Q33}, {c4 * Q2[0] - s4 * Q11, c4 * Q2[1] - s4 * Q12}, h};
}

struct Wrist {
  double q4, q5, q6;
  double h;
};
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
// The shoulder and elbow q stands in; where the wrist centre passes close by axis 1, the shoulder
// that turns joint 1 by less than a quarter.
ArmSide side_of(const ArmGeometry& g, const WristCentre& w, const Vec6& q) noexcept {
  const SinCos<2> t = sincos<2>(q.data() + 1);
  const double r = g.a2 * t.c[0] + g.d4 * (t.s[0] * t.c[1] + t.c[0] * t.s[1]);
  const bool passing = std::abs(r) < kPassing && w.r < kPassing;
  const double forward = passing ? w.x * std::cos(q[0]) + w.y * std::sin(q[0]) : r;
  return {forward >= 0 ? 1 : -1, t.c[1] >= 0 ? 1 : -1};
}

// q unwrapped to be next to the previous one, with either wrist, and how long the wrist joints need
// to get there.
struct Continuation {
  Vec6 q;
  double time;
};
Continuation continued(const Vec3& arm, const Wrist& w, const Vec6& previous,
                       const Vec3& wrist_speed) noexcept {
  const double q4 = unwrapped(w.q4, previous[3]), q5 = unwrapped(w.q5, previous[4]),
               q6 = unwrapped(w.q6, previous[5]);
  Continuation out{.time = std::max({std::abs(q4 - previous[3]) / wrist_speed[0],
                                     std::abs(q5 - previous[4]) / wrist_speed[1],
                                     std::abs(q6 - previous[5]) / wrist_speed[2]})};
  out.q << arm, q4, q5, q6;
  return out;
}

bool within(const JointLimits& limits, const Vec6& q) noexcept {
  double spare = q[0] - limits.lower[0];
  for (int i = 0; i < 6; ++i)
    spare = std::min({spare, q[i] - limits.lower[i], limits.upper[i] - q[i]});
  return spare >= -kLimitRounding;
}

}  // namespace

// By symmetry the arm behind, with the other elbow, repeats the one in front, and the other elbow's
// q3 mirrors this one's: ten arctangents in all.
ArmInverse inverse_all(const ArmGeometry& g, const Pose& X_SE, const Vec6& q_previous) noexcept {
  const WristCentre w = wrist_centre(g, X_SE, q_previous);
  ArmInverse out{.status = w.status, .miss = w.miss};
  if (w.status != Status::ok) return out;
  const Shoulder front = shoulder(w, 1, q_previous[0]);
  const ArmPlane p = plane(g, w, front.r, Lanes{1, -1}, q_previous[1]);
  const WristDirections k = wrist_directions(X_SE.R, front, p, q_previous[3]);
  const Lanes q13 = atan2(Lanes{front.y, w.sin_q3}, Lanes{front.x, w.cos_q3});
  const Lanes q2 = atan2(p.j2.y, p.j2.x), q4 = atan2(k.j4.y, k.j4.x);
  const Lanes q5 = atan2(k.j5.y, k.j5.x), q6 = atan2(k.j6.y, k.j6.x);

  const bool on_axis = w.r == 0;
  const double q1 = on_axis ? wrapped(q_previous[0]) : q13[0];
  const double q3_up = q13[1], q3_down = on_own_side(opposite(-q13[1]), -1);
  const auto put = [&](ArmBranch b, double j1, double j2, const Wrist& j) {
    const double j3 = b.elbow > 0 ? q3_up : q3_down;
    out.rows[static_cast<std::size_t>(row_of(b))] << j1, j2, j3, j.q4, j.q5, j.q6;
  };
  for (const std::size_t lane : {0, 1}) {
    const int elbow = lane == 0 ? 1 : -1, behind_elbow = on_axis ? elbow : -elbow;
    const double h = k.h[lane];
    const Wrist front_wrist{h > 0 ? q4[lane] : wrapped(q_previous[3]), q5[lane], q6[lane], h};
    const Wrist behind = on_axis ? front_wrist : carried_behind(front_wrist);
    put({1, elbow, 1}, q1, q2[lane], front_wrist);
    put({1, elbow, -1}, q1, q2[lane], flipped(front_wrist));
    const double behind_q1 = on_axis ? q1 : opposite(q1);
    const double behind_q2 = on_axis ? q2[lane] : opposite(-q2[lane]);
    put({-1, behind_elbow, 1}, behind_q1, behind_q2, behind);
    put({-1, behind_elbow, -1}, behind_q1, behind_q2, flipped(behind));
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
  const ArmPlane p = plane(g, w, a.r, lanes(side.elbow), q_previous[1]);
  const WristDirections d = wrist_directions(X_SE.R, a, p, q_previous[3]);
  const Lanes q13 = atan2(Lanes{a.y, w.sin_q3}, Lanes{a.x, side.elbow * w.cos_q3});
  const Lanes q24 = atan2(Lanes{p.j2.y[0], d.j4.y[0]}, Lanes{p.j2.x[0], d.j4.x[0]});
  const Lanes q56 = atan2(Lanes{d.j5.y[0], d.j6.y[0]}, Lanes{d.j5.x[0], d.j6.x[0]});
  const double h = d.h[0];
  const Wrist k{h > 0 ? q24[1] : q_previous[3], q56[0], q56[1], h};
  const Vec3 arm(unwrapped(w.r > 0 ? q13[0] : q_previous[0], q_previous[0]),
                 unwrapped(q24[0], q_previous[1]),
                 unwrapped(on_own_side(q13[1], side.elbow), q_previous[2]));
  const Vec3 speed = limits.speed.tail<3>();
  const std::array<Continuation, 2> both{continued(arm, k, q_previous, speed),
                                         continued(arm, flipped(k), q_previous, speed)};
  const bool flip = both[1].time < both[0].time;
  const Continuation &sooner = both[flip], &later = both[!flip];
  const bool about_as_near = later.time < kAboutAsNear * sooner.time;
  const bool refused = about_as_near && !within(limits, sooner.q) && within(limits, later.q);
  const Vec6& q = refused ? later.q : sooner.q;

  const bool negative = q[4] < 0 || (q[4] == 0 && q_previous[4] < 0);
  out.branch = {side.shoulder, side.elbow, negative ? -1 : 1};
  out.singularity = {.wrist = k.h, .elbow = w.cos_q3, .shoulder = w.r};
  out.status = within(limits, q) ? Status::ok : Status::out_of_limits;
  if (out.status == Status::ok) out.q = q.cwiseMax(limits.lower).cwiseMin(limits.upper);
  return out;
}

}  // namespace farhand
