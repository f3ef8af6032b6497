// Derivatives by differences and random directions, for checking kinematics against themselves.
#pragma once

#include <cmath>
#include <random>

#include "common/geometry.hpp"

namespace farhand::support {

// Sanitizers slow the kinematics by an order of magnitude: there a tenth of the poses will do.
#ifdef FARHAND_SANITIZED
inline constexpr int kRandomPoses = 100'000;
#else
inline constexpr int kRandomPoses = 1'000'000;
#endif

// d f(t)/dt at 0 by the central difference of sixth order: error O(h^6) + rounding/h. `f` returns a
// vector of angles that do not wrap near t = 0.
template <typename Vector, typename F>
Vector derivative(F&& f, double h) {
  const Vector d1 = f(h) - f(-h), d2 = f(2 * h) - f(-2 * h), d3 = f(3 * h) - f(-3 * h);
  return (45 * d1 - 9 * d2 + d3) / (60 * h);
}

inline double uniform(std::mt19937_64& random, double low, double high) {
  return std::uniform_real_distribution<double>(low, high)(random);
}

// Uniform in the cube [-1, 1]^3.
inline Vec3 in_cube(std::mt19937_64& random) {
  const double x = uniform(random, -1, 1), y = uniform(random, -1, 1);
  return {x, y, uniform(random, -1, 1)};
}

// Uniform in the ball of radius r about the origin.
inline Vec3 in_ball(std::mt19937_64& random, double r) {
  for (;;) {
    const Vec3 x = in_cube(random);
    if (x.norm() <= 1) return r * x;
  }
}

// Uniform on the unit sphere.
inline Vec3 on_sphere(std::mt19937_64& random) {
  for (;;) {
    const Vec3 x = in_cube(random);
    if (x.norm() <= 1 && x.norm() > 0.1) return x.normalized();
  }
}

// Angle [rad] between two vectors, accurate when it is tiny.
inline double angle_between(const Vec3& a, const Vec3& b) {
  return std::atan2(a.cross(b).norm(), a.dot(b));
}

}  // namespace farhand::support
