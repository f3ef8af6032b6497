// The handles' loop closures as equations, and the plain ways to solve them, in any precision: what
// the product's closed forms are compared with (float, double) and judged by (Quad). Leg equations:
// reference sections 2.3, 5.2 and 5.4.
#pragma once

#include <quadmath.h>

#include <array>
#include <cmath>

#include "master/falcon.hpp"
#include "master/twin_delta.hpp"

namespace farhand::bench {

__extension__ typedef __float128 Quad;

template <typename T>
T sine(T x) {
  if constexpr (std::is_same_v<T, Quad>)
    return sinq(x);
  else
    return std::sin(x);
}
template <typename T>
T cosine(T x) {
  if constexpr (std::is_same_v<T, Quad>)
    return cosq(x);
  else
    return std::cos(x);
}
template <typename T>
T root(T x) {
  if constexpr (std::is_same_v<T, Quad>)
    return sqrtq(x);
  else
    return std::sqrt(x);
}

template <typename T>
using Point = std::array<T, 3>;
template <typename T>
Point<T> point(const Vec3& p) {
  return {static_cast<T>(p.x()), static_cast<T>(p.y()), static_cast<T>(p.z())};
}

// How far the end of a leg's bar misses its place, as a difference of squares, and its gradient.
template <typename T>
struct Closure {
  T miss;
  Point<T> gradient;
};

template <typename T>
Closure<T> falcon_closure(const FalconGeometry& g, int leg, T cos1, T sin1, const Point<T>& p) {
  const auto i = static_cast<std::size_t>(leg);
  const T a = T(g.a), b = T(g.b), h = T(g.d) + T(g.e);
  const T cx = T(g.cos_phi[i]), sx = T(g.sin_phi[i]);
  const T u = cx * p[0] + sx * p[1] - (T(g.r) - T(g.c) + a * cos1);
  const T v = cx * p[1] - sx * p[0] - (T(g.s) - T(g.f));
  const T w = p[2] - a * sin1, in_plane = root<T>(u * u + w * w);
  const T k = 2 * (in_plane - h) / in_plane;
  return {(in_plane - h) * (in_plane - h) + v * v - b * b,
          {k * u * cx - 2 * v * sx, k * u * sx + 2 * v * cx, k * w}};
}

// Where the forearm's sphere has its centre, in the axes of the half.
template <typename T>
Point<T> twin_delta_centre(const TwinDeltaGeometry& g, int leg, T cos1, T sin1) {
  const T L1 = T(g.L1[static_cast<std::size_t>(leg)]);
  const T side = T(g.d) - T(g.a);
  if (leg == 2) return {T(g.d) - T(g.b) + L1 * cos1, T(0), T(g.c) - T(g.h) - L1 * sin1};
  return {L1 * cos1, (leg == 0 ? side : -side) + L1 * sin1, -T(g.h)};
}

template <typename T>
Closure<T> twin_delta_closure(const TwinDeltaGeometry& g, int leg, T cos1, T sin1,
                              const Point<T>& e) {
  const Point<T> S = twin_delta_centre<T>(g, leg, cos1, sin1);
  const T L2 = T(g.L2[static_cast<std::size_t>(leg)]);
  const Point<T> n{e[0] - S[0], e[1] - S[1], e[2] - S[2]};
  return {n[0] * n[0] + n[1] * n[1] + n[2] * n[2] - L2 * L2, {2 * n[0], 2 * n[1], 2 * n[2]}};
}

// Newton's method on three closures f(leg, p), until a step is below `tolerance` [m].
template <typename T, typename F>
Point<T> newton(F&& f, Point<T> p, T tolerance) {
  for (int i = 0; i < 20; ++i) {
    const Closure<T> c[3] = {f(0, p), f(1, p), f(2, p)};
    const auto& [x, y, z] = std::tie(c[0].gradient, c[1].gradient, c[2].gradient);
    const auto cross = [](const Point<T>& s, const Point<T>& t) {
      return Point<T>{s[1] * t[2] - s[2] * t[1], s[2] * t[0] - s[0] * t[2],
                      s[0] * t[1] - s[1] * t[0]};
    };
    const Point<T> yz = cross(y, z), zx = cross(z, x), xy = cross(x, y);
    const T det = x[0] * yz[0] + x[1] * yz[1] + x[2] * yz[2];
    T square = 0;
    for (std::size_t k = 0; k < 3; ++k) {
      const T step = (c[0].miss * yz[k] + c[1].miss * zx[k] + c[2].miss * xy[k]) / det;
      p[k] -= step;
      square += step * step;
    }
    if (!(square > tolerance * tolerance)) break;
  }
  return p;
}

template <typename T>
struct Legs3 {
  T c[3], s[3];
  template <typename V>
  explicit Legs3(const V& theta, int from = 0) {
    for (int i = 0; i < 3; ++i)
      c[i] = cosine<T>(T(theta[from + i])), s[i] = sine<T>(T(theta[from + i]));
  }
};

template <typename T>
Point<T> falcon_newton(const FalconGeometry& g, const Vec3& theta1, const Point<T>& start,
                       T tolerance) {
  const Legs3<T> legs(theta1);
  return newton<T>(
      [&](int i, const Point<T>& p) { return falcon_closure<T>(g, i, legs.c[i], legs.s[i], p); },
      start, tolerance);
}
// Half 0 or 1, in the axes of the half.
template <typename T>
Point<T> twin_delta_newton(const TwinDeltaGeometry& g, const Vec6& theta1, int half,
                           const Point<T>& start, T tolerance) {
  const Legs3<T> legs(theta1, 3 * half);
  return newton<T>(
      [&](int i, const Point<T>& e) {
        return twin_delta_closure<T>(g, i, legs.c[i], legs.s[i], e);
      },
      start, tolerance);
}

// The ends of the grip in the axes of their halves, and back.
template <typename T>
std::array<Point<T>, 2> ends_in_halves(const TwinDeltaGeometry& g, const TwinDeltaPose& pose) {
  const Point<T> p = point<T>(pose.p_MH), u = point<T>(pose.axis);
  const T l = T(pose.length) / 2, a = T(g.a12);
  return {{{p[0] + l * u[0], p[1] + l * u[1], p[2] + l * u[2] - a},
           {p[0] - l * u[0], -(p[1] - l * u[1]), -(p[2] - l * u[2]) - a}}};
}

// Where the forearms of a half meet, by elimination in vectors.
template <typename T>
Point<T> twin_delta_spheres(const TwinDeltaGeometry& g, const Vec6& theta1, int half) {
  using V = Eigen::Matrix<T, 3, 1>;
  const Legs3<T> legs(theta1, 3 * half);
  V S[3];
  for (int i = 0; i < 3; ++i) {
    const Point<T> centre = twin_delta_centre<T>(g, i, legs.c[i], legs.s[i]);
    S[i] = V(centre[0], centre[1], centre[2]);
  }
  const T r = T(g.L2[0]);  // all three are alike
  const V P = S[1] - S[0], Q = S[2] - S[0], N = P.cross(Q);
  const T nn = N.squaredNorm();
  const V W = (P.squaredNorm() / 2 * Q.cross(N) + Q.squaredNorm() / 2 * N.cross(P)) / nn;
  const V e = S[0] + W + root<T>((r * r - W.squaredNorm()) / nn) * N;
  return {e.x(), e.y(), e.z()};
}

// Angle of a motor arm by the law of cosines, as textbooks have it: loses half of the digits where
// the leg is stretched.
template <typename T>
T law_of_cosines(T x, T y, T arm, T bar, T bend) {
  const T reach2 = x * x + y * y;
  const T cosine = (reach2 + arm * arm - bar * bar) / (2 * arm * std::sqrt(reach2));
  return std::atan2(y, x) - bend * std::acos(cosine);
}

template <typename T>
Eigen::Matrix<T, 3, 1> falcon_angles(const FalconGeometry& g, const Vec3& p_MH) {
  Eigen::Matrix<T, 3, 1> out;
  const Point<T> p = point<T>(p_MH);
  for (int i = 0; i < 3; ++i) {
    const auto k = static_cast<std::size_t>(i);
    const T cx = T(g.cos_phi[k]), sx = T(g.sin_phi[k]);
    const T u = cx * p[0] + sx * p[1] + T(g.c - g.r), v = cx * p[1] - sx * p[0] + T(g.f - g.s);
    const T rho = T(g.d + g.e) + std::sqrt(T(g.b) * T(g.b) - v * v);
    out[i] = law_of_cosines<T>(u, p[2], T(g.a), rho, 1);
  }
  return out;
}

template <typename T>
Eigen::Matrix<T, 6, 1> twin_delta_angles(const TwinDeltaGeometry& g, const TwinDeltaPose& pose) {
  Eigen::Matrix<T, 6, 1> out;
  const std::array<Point<T>, 2> ends = ends_in_halves<T>(g, pose);
  for (int k = 0; k < 6; ++k) {
    const int leg = k % 3;
    const auto i = static_cast<std::size_t>(leg);
    const auto& [x, y, z] = ends[static_cast<std::size_t>(k / 3)];
    const T side = leg == 0 ? T(g.a - g.d) : T(g.d - g.a);
    const T u = leg == 2 ? x + T(g.b - g.d) : x;
    const T v = leg == 2 ? T(g.c - g.h) - z : y + side;
    const T w = leg == 2 ? y : z + T(g.h);
    const T bar = std::sqrt(T(g.L2[i]) * T(g.L2[i]) - w * w);
    out[k] = law_of_cosines<T>(u, v, T(g.L1[i]), bar, leg == 1 ? T(-1) : T(1));
  }
  return out;
}

}  // namespace farhand::bench
