#include "tests/bench/quad.hpp"

#include <algorithm>
#include <numbers>

namespace farhand::bench {
namespace {

using Point3 = Point<Quad>;
constexpr double kTolerance = 1e-25;  // [m]

Quad absolute(Quad x) {
  return x < 0 ? -x : x;
}
// Infinite for what is no number: a maximum would lose it.
double distance(Quad exact, double x) {
  return std::isfinite(x) ? static_cast<double>(absolute(exact - Quad(x))) : INFINITY;
}
double turn_between(Quad exact, double x) {
  const double d = distance(exact, x);
  return std::isfinite(d) ? std::abs(std::remainder(d, 2 * std::numbers::pi)) : d;
}

Point3 cross(const Point3& a, const Point3& b) {
  return {a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0]};
}

// A frame of the chain as three columns and an origin.
struct Frame {
  Point3 x{1, 0, 0}, y{0, 1, 0}, z{0, 0, 1}, o{0, 0, 0};
};

// Rz(q) Tz(d) Tx(a) Rx(alpha), alpha a multiple of a right angle.
Frame follow(const Frame& f, Quad q, Quad d, Quad a, int cos_alpha, int sin_alpha) {
  const Quad c = cosine<Quad>(q), s = sine<Quad>(q);
  Frame out;
  for (std::size_t k = 0; k < 3; ++k) {
    const Quad turned = -s * f.x[k] + c * f.y[k];
    out.x[k] = c * f.x[k] + s * f.y[k];
    out.y[k] = cos_alpha * turned + sin_alpha * f.z[k];
    out.z[k] = -sin_alpha * turned + cos_alpha * f.z[k];
    out.o[k] = f.o[k] + d * f.z[k] + a * out.x[k];
  }
  return out;
}

// The zero of f(angle) next to `near`, by secants.
template <typename F>
Quad zero(F&& f, double near) {
  Quad a = near, b = a + Quad(1e-7), fa = f(a), fb = f(b);
  for (int i = 0; i < 12 && fa != fb && absolute(b - a) > Quad(1e-30); ++i) {
    const Quad next = b - fb * (b - a) / (fb - fa);
    a = b, fa = fb;
    b = next, fb = f(b);
  }
  return b;
}

}  // namespace

QuadArm quad_arm(const ArmGeometry& g, const Vec6& q) {
  const double d[] = {g.d1, 0, 0, g.d4, 0, g.d6}, a[] = {0, g.a2, 0, 0, 0, 0};
  const int cos_alpha[] = {0, 1, 0, 0, 0, 1}, sin_alpha[] = {1, 0, 1, -1, 1, 0};
  Frame f;
  std::array<Point3, 6> origin;
  QuadArm out;
  for (std::size_t i = 0; i < 6; ++i) {
    origin[i] = f.o;
    out.angular[i] = f.z;
    f = follow(f, q[static_cast<Eigen::Index>(i)], d[i], a[i], cos_alpha[i], sin_alpha[i]);
  }
  for (std::size_t i = 0; i < 6; ++i)
    out.linear[i] = cross(out.angular[i],
                          {f.o[0] - origin[i][0], f.o[1] - origin[i][1], f.o[2] - origin[i][2]});
  for (std::size_t k = 0; k < 3; ++k) out.R[k] = {f.x[k], f.y[k], f.z[k]};
  out.p = f.o;
  return out;
}

Pose rounded(const QuadArm& arm) {
  Pose X;
  for (int i = 0; i < 3; ++i) {
    const auto k = static_cast<std::size_t>(i);
    for (int j = 0; j < 3; ++j)
      X.R(i, j) = static_cast<double>(arm.R[k][static_cast<std::size_t>(j)]);
    X.p[i] = static_cast<double>(arm.p[k]);
  }
  return X;
}

double pose_error(const QuadArm& arm, const Pose& X) {
  double worst = 0;
  for (int i = 0; i < 3; ++i) {
    const auto k = static_cast<std::size_t>(i);
    for (int j = 0; j < 3; ++j)
      worst = std::max(worst, distance(arm.R[k][static_cast<std::size_t>(j)], X.R(i, j)));
    worst = std::max(worst, distance(arm.p[k], X.p[i]));
  }
  return worst;
}

double jacobian_error(const QuadArm& arm, const ArmJacobian& J) {
  double worst = 0;
  for (int j = 0; j < 6; ++j)
    for (int i = 0; i < 3; ++i) {
      const auto joint = static_cast<std::size_t>(j), k = static_cast<std::size_t>(i);
      worst = std::max({worst, distance(arm.linear[joint][k], J.linear(i, j)),
                        distance(arm.angular[joint][k], J.angular(i, j))});
    }
  return worst;
}

double residual(const ArmGeometry& geometry, const Vec6& q, const Pose& X_SE) {
  return q.allFinite() ? pose_error(quad_arm(geometry, q), X_SE) : INFINITY;
}

double falcon_position_error(const FalconGeometry& g, const Vec3& theta1, const Vec3& p_MH,
                             const Vec3& near) {
  const Point3 p = falcon_newton<Quad>(g, theta1, point<Quad>(near), kTolerance);
  return std::max({distance(p[0], p_MH[0]), distance(p[1], p_MH[1]), distance(p[2], p_MH[2])});
}

double twin_delta_position_error(const TwinDeltaGeometry& g, const Vec6& theta1,
                                 const TwinDeltaPose& pose, const TwinDeltaPose& near) {
  if (!pose.p_MH.allFinite() || !pose.axis.allFinite()) return INFINITY;
  const auto start = ends_in_halves<Quad>(g, near), given = ends_in_halves<Quad>(g, pose);
  double worst = 0;
  for (int half = 0; half < 2; ++half) {
    const auto h = static_cast<std::size_t>(half);
    const Point3 e = twin_delta_newton<Quad>(g, theta1, half, start[h], kTolerance);
    for (std::size_t k = 0; k < 3; ++k)
      worst = std::max(worst, static_cast<double>(absolute(e[k] - given[h][k])));
  }
  return worst;
}

double falcon_angle_error(const FalconGeometry& g, const Vec3& p_MH, const Vec3& theta1,
                          const Vec3& near) {
  double worst = 0;
  for (int i = 0; i < 3; ++i) {
    const auto miss = [&](Quad t) {
      return falcon_closure<Quad>(g, i, cosine<Quad>(t), sine<Quad>(t), point<Quad>(p_MH)).miss;
    };
    worst = std::max(worst, turn_between(zero(miss, near[i]), theta1[i]));
  }
  return worst;
}

double twin_delta_angle_error(const TwinDeltaGeometry& g, const TwinDeltaPose& pose,
                              const Vec6& theta1, const Vec6& near) {
  const auto ends = ends_in_halves<Quad>(g, pose);
  double worst = 0;
  for (int i = 0; i < 6; ++i) {
    const auto miss = [&](Quad t) {
      return twin_delta_closure<Quad>(g, i % 3, cosine<Quad>(t), sine<Quad>(t),
                                      ends[static_cast<std::size_t>(i / 3)])
          .miss;
    };
    worst = std::max(worst, turn_between(zero(miss, near[i]), theta1[i]));
  }
  return worst;
}

}  // namespace farhand::bench
