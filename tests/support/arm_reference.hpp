// The serial arm once more, as the plain product of its six DH matrices in long double: what the
// accuracy tests measure against. Shares nothing with slave/arm.cpp but the geometry.
#pragma once

#include <array>
#include <cmath>
#include <random>

#include "slave/arm.hpp"

namespace farhand::reference {

using Real = long double;
using RealPose = std::array<std::array<Real, 4>, 3>;  // [R | p]

// a, d in m; the sine and cosine of alpha are exactly 0 or +-1.
struct Link {
  Real a, d;
  int cos_alpha, sin_alpha;
};
inline std::array<Link, 6> links(const ArmGeometry& g) {
  return {{{0, g.d1, 0, 1},
           {g.a2, 0, 1, 0},
           {0, 0, 0, 1},
           {0, g.d4, 0, -1},
           {0, 0, 0, 1},
           {0, g.d6, 1, 0}}};
}

inline RealPose append(const RealPose& X, const Link& l, Real q) {
  const Real c = std::cos(q), s = std::sin(q);
  const Real T[4][4] = {{c, -s * l.cos_alpha, s * l.sin_alpha, l.a * c},
                        {s, c * l.cos_alpha, -c * l.sin_alpha, l.a * s},
                        {0, Real(l.sin_alpha), Real(l.cos_alpha), l.d},
                        {0, 0, 0, 1}};
  RealPose out{};
  for (std::size_t i = 0; i < 3; ++i)
    for (std::size_t j = 0; j < 4; ++j)
      for (std::size_t k = 0; k < 4; ++k) out[i][j] += (k < 3 || j == 3 ? X[i][k] * T[k][j] : 0);
  return out;
}

template <typename Joints>
RealPose forward(const ArmGeometry& g, const Joints& q) {
  RealPose X{{{1, 0, 0, 0}, {0, 1, 0, 0}, {0, 0, 1, 0}}};
  std::size_t i = 0;
  for (const Link& l : links(g)) X = append(X, l, static_cast<Real>(q[i++]));
  return X;
}

inline Pose rounded(const RealPose& X) {
  Pose out;
  for (int i = 0; i < 3; ++i) {
    const auto& row = X[static_cast<std::size_t>(i)];
    out.R.row(i) << double(row[0]), double(row[1]), double(row[2]);
    out.p[i] = static_cast<double>(row[3]);
  }
  return out;
}

inline RealPose exact(const Pose& X) {
  RealPose out;
  for (int i = 0; i < 3; ++i)
    out[static_cast<std::size_t>(i)] = {X.R(i, 0), X.R(i, 1), X.R(i, 2), X.p[i]};
  return out;
}

// How far the wrist centre lies outside the shell of the reach; negative inside it.
inline Real miss(const ArmGeometry& g, const Pose& X_SE) {
  const RealPose X = exact(X_SE);
  const auto w = [&](std::size_t i) { return X[i][3] - g.d6 * X[i][2]; };
  const Real rho = std::hypot(w(0), w(1), w(2) - g.d1), a2 = g.a2, d4 = g.d4;
  return std::max(rho - (a2 + d4), std::abs(a2 - d4) - rho);
}

// The row of the working branch (+1, +1, +1), straight from reference section 7.2.
inline std::array<Real, 6> working_row(const ArmGeometry& g, const Pose& X_SE) {
  const RealPose X = exact(X_SE);
  const Real a2 = g.a2, d4 = g.d4;
  const Real x = X[0][3] - g.d6 * X[0][2], y = X[1][3] - g.d6 * X[1][2];
  const Real z = X[2][3] - g.d6 * X[2][2] - g.d1, r = std::hypot(x, y);
  const Real D = (r * r + z * z - a2 * a2 - d4 * d4) / (2 * a2 * d4);
  const Real q1 = std::atan2(y, x), q3 = std::atan2(D, std::sqrt((1 - D) * (1 + D)));
  const Real A = a2 + d4 * std::sin(q3), B = d4 * std::cos(q3);
  const Real q2 = std::atan2(z * A + r * B, r * A - z * B);
  const Real c1 = std::cos(q1), s1 = std::sin(q1), c23 = std::cos(q2 + q3), s23 = std::sin(q2 + q3);
  std::array<std::array<Real, 3>, 3> Q;
  for (std::size_t j = 0; j < 3; ++j) {
    const Real radial = c1 * X[0][j] + s1 * X[1][j];
    Q[0][j] = c23 * radial + s23 * X[2][j];
    Q[1][j] = s1 * X[0][j] - c1 * X[1][j];
    Q[2][j] = s23 * radial - c23 * X[2][j];
  }
  const Real q4 = std::atan2(Q[1][2], Q[0][2]);
  return {q1,
          q2,
          q3,
          q4,
          std::atan2(std::hypot(Q[0][2], Q[1][2]), Q[2][2]),
          std::atan2(std::cos(q4) * Q[1][0] - std::sin(q4) * Q[0][0],
                     std::cos(q4) * Q[1][1] - std::sin(q4) * Q[0][1])};
}

// Distance [m] and largest difference of an element of the rotation.
struct PoseError {
  double position = 0, rotation = 0;
  void raise(const PoseError& e) {
    position = std::max(position, e.position);
    rotation = std::max(rotation, e.rotation);
  }
};
inline PoseError pose_error(const RealPose& X, const Pose& target) {
  Real square = 0, rotation = 0;
  for (std::size_t i = 0; i < 3; ++i) {
    const auto row = static_cast<Eigen::Index>(i);
    square += (X[i][3] - target.p[row]) * (X[i][3] - target.p[row]);
    for (std::size_t j = 0; j < 3; ++j)
      rotation =
          std::max(rotation, std::abs(X[i][j] - target.R(row, static_cast<Eigen::Index>(j))));
  }
  return {static_cast<double>(std::sqrt(square)), static_cast<double>(rotation)};
}

inline double uniform(std::mt19937_64& rng, double low, double high) {
  return std::uniform_real_distribution<double>(low, high)(rng);
}
inline Vec3 random_vector(std::mt19937_64& rng, double size) {
  return {uniform(rng, -size, size), uniform(rng, -size, size), uniform(rng, -size, size)};
}
inline Vec6 random_joints(std::mt19937_64& rng, const JointLimits& limits = {}) {
  Vec6 q;
  for (int i = 0; i < 6; ++i) q[i] = uniform(rng, limits.lower[i], limits.upper[i]);
  return q;
}

}  // namespace farhand::reference
