// The Falcon: three motor arms, three parallelograms, a platform that only translates. Motor angles
// theta1 [rad] to the position p_MH [m] of the grip in the base frame M (X right, Y up, Z to the
// user) and back, and the same for velocities and forces.
//
// Leg frame: u radial outwards, v tangential, w = Z. theta1 from u towards w (the motor); theta2
// the forearm's direction in the u-w plane, same sense; theta3 in (0, pi) between the bar and v.
// With A = u + c and rho = d + e + b sin(theta3) the loops close as
//
//   A = a cos t1 + rho cos t2      v + f = b cos t3      w = a sin t1 + rho sin t2
//
// (Falcon publication eq. 1-8 with its errata; reference sections 2, 3.) The knee is the outward
// one.
#pragma once

#include <array>
#include <numbers>

#include "common/geometry.hpp"
#include "common/status.hpp"
#include "master/closure.hpp"

namespace farhand {

// Lengths in metres, named as in the publication's table. Only d + e, c - r and f - s matter.
struct FalconGeometry {
  double a = 0.0600;  // upper arm, motor joint to knee
  double b = 0.1025;  // parallelogram bar
  double c = 0.0157;  // platform: leg end to grip centre, radial
  double d = 0.0115;  // links on both sides of the parallelogram
  double e = 0.0115;
  double f = 0.0262;  // platform, tangential
  double r = 0.0366;  // base: origin to motor joint, radial
  double s = 0.0272;  // base, tangential
  // Directions of the legs about Z: cos and sin of phi = 105, -15, -135 deg.
  std::array<double, 3> cos_phi{-0.25881904510252076, 0.96592582628906829, -0.70710678118654752};
  std::array<double, 3> sin_phi{0.96592582628906829, -0.25881904510252076, -0.70710678118654752};
  // Encoder: theta1 = angle_offset + counts * quantum, see theta1_quantum.
  double gear_ratio = 7.62;  // motor turns per arm turn
  double counts_per_motor_turn = 1280;
  double angle_offset = 35 * std::numbers::pi / 180;  // theta1 at count 0 [rad]; calibrate
};

inline constexpr FalconGeometry kFalconTable1{};
inline constexpr FalconGeometry kFalconTable1S0{.s = 0};  // eq. 1 as printed
inline constexpr FalconGeometry kFalconTable1Flip{.f = -0.0262, .s = -0.0272};
inline constexpr FalconGeometry kFalconLibnifalcon{.c = 0.01443,
                                                   .d = 0.01125,
                                                   .e = 0.01125,
                                                   .f = -0.025,
                                                   .r = 0.04,
                                                   .s = -0.02309,
                                                   .gear_ratio = 110 / 14.25};
inline constexpr FalconGeometry kFalconSpheric{.b = 0.1255, .d = 0, .e = 0};  // for tests

// Arm angle of one encoder count [rad].
constexpr double theta1_quantum(const FalconGeometry& g) noexcept {
  return 2 * std::numbers::pi / (g.gear_ratio * g.counts_per_motor_turn);
}
Vec3 theta1_from_counts(const FalconGeometry& g, const Eigen::Vector3i& counts) noexcept;
// The nearest count, held within the encoder's 16 bits; 0 for an angle that is not finite.
Eigen::Vector3i counts_from_theta1(const FalconGeometry& g, const Vec3& theta1) noexcept;

// Inverse kinematics of one leg from its end in the leg frame, uvw [m]. theta1_other is the
// knee-inward root. Angles are zero unless status is ok. lateral_limit: |v + f| > b; too_far;
// too_close.
struct FalconLeg {
  Status status = Status::not_finite;
  double theta1 = 0, theta2 = 0, theta3 = 0, theta1_other = 0;
};
FalconLeg leg_inverse(const FalconGeometry& g, const Vec3& uvw) noexcept;

// All angles of all legs. status is that of the first leg that fails; the others are still solved.
struct FalconInverse {
  Status status = Status::not_finite;
  std::array<Status, 3> legs{status, status, status};
  Vec3 theta1 = Vec3::Zero(), theta2 = Vec3::Zero(), theta3 = Vec3::Zero();
  Vec3 theta1_other = Vec3::Zero();
};
FalconInverse inverse(const FalconGeometry& g, const Vec3& p_MH) noexcept;

// The fast path: theta1 alone, one arctangent per leg. theta1 is zero unless status is ok.
struct FalconMotorAngles {
  Status status = Status::not_finite;
  Vec3 theta1 = Vec3::Zero();
};
FalconMotorAngles motor_angles(const FalconGeometry& g, const Vec3& p_MH) noexcept;

// Forward kinematics. A leg holds the grip on a torus, not on a sphere, so this is a Newton search
// (at most 8 steps, each at most 30 mm) whose last step is below 1e-9 m: the answer is good to
// rounding. Only the working assembly counts, knees outward and det_n < 0: otherwise no_solution.
struct FalconForward {
  Status status = Status::not_finite;
  Vec3 p_MH = Vec3::Zero();
  int iterations = 0;
  Vec3 cos1 = Vec3::Zero(), sin1 = Vec3::Zero();  // of theta1, for jacobian()
};
// From nothing: starts where three spheres of radius b + d + e meet.
FalconForward forward(const FalconGeometry& g, const Vec3& theta1) noexcept;
// From the previous sample's position; falls back on the cold start if that leads nowhere.
FalconForward forward(const FalconGeometry& g, const Vec3& theta1, const Vec3& p_previous) noexcept;

// Velocities and forces at a position. min_abs_sin = min |sin(t1 - t2)|: 0 at the workspace edge.
// det_n = det of the unit bar directions: 0 where the platform gains a freedom. Status: that of the
// kinematics, or singular.
struct FalconJacobian {
  Status status = Status::not_finite;
  BarMap map{};
  double det_n = 0;
  double min_abs_sin = 0;
};
FalconJacobian jacobian(const FalconGeometry& g, const Vec3& p_MH) noexcept;
FalconJacobian jacobian(const FalconGeometry& g, const FalconForward& at) noexcept;

// Where forces may be commanded: det_n <= -0.1 and min_abs_sin >= 0.1 (reference section 2.4).
bool accepted(const FalconGeometry& g, const FalconJacobian& J) noexcept;

// Force on the hand [N], M axes, that keeps the grip from leaving the accepted workspace: the sum
// over both measures, the second of every leg. Zero if J is not ok.
Vec3 edge_force(const FalconGeometry& g, const FalconForward& at, const FalconJacobian& J,
                const WorkspaceEdge& edge) noexcept;

// Jinv of theta_dot = Jinv v_MH [1/m], rows = legs (the transpose of what eq. 11 prints). Zero if
// status is not ok.
Mat3 inverse_jacobian(const FalconJacobian& J) noexcept;
// Motor torques [N m] with which the grip pushes the hand with f_H_M [N]: solves Jinv^T tau = f.
// The torque of a Jacobian that is not ok, or of a force that is not finite, is zero.
Vec3 torque(const FalconJacobian& J, const Vec3& f_H_M) noexcept;
// Force of the grip on the hand, f_H_M = Jinv^T tau. Zero under the same conditions, as below.
Vec3 force(const FalconJacobian& J, const Vec3& tau) noexcept;
Vec3 theta_rates(const FalconJacobian& J, const Vec3& v_MH) noexcept;
Vec3 velocity(const FalconJacobian& J, const Vec3& theta_rates) noexcept;

}  // namespace farhand
