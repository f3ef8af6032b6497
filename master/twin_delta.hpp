// The six-degree handle: two three-legged structures hold the two ends E1 (upper) and E2 (lower) of
// a grip whose length changes with its twist. Six motor angles theta1 [rad] to the grip's centre
// p_MH [m], its axis (unit vector from E2 to E1) and its length [m], and back, and the same for
// velocities and forces.
//
// Base frame M: Z up, X from the base to the user, gravity along -Z. Legs 0, 1, 2 are the upper
// structure in frame A1: axes of M, origin (0, 0, a12). Legs 3, 4, 5 are the same structure in
// frame A2, turned by D = diag(1, -1, -1), origin (0, 0, -a12). (Twin-delta publication eq. 2-38
// with its errata; reference sections 5, 6.) Knees: legs 0, 1, 3, 4 outwards, legs 2, 5 away from
// the other half.
//
// Forces, torques and velocities are in the handle axes G without twist (handle_axes), about the
// centre H. Twist.angular.z is the rate of the twist against the screws, and Wrench.torque.z the
// torque on that twist. The secondary couple of the universal joints is left out, as in the
// publication.
#pragma once

#include <array>
#include <numbers>

#include "common/geometry.hpp"
#include "common/status.hpp"
#include "master/closure.hpp"

namespace farhand {

// Lengths in metres, named as in the publication's table.
struct TwinDeltaGeometry {
  double a = 0.042;                               // half distance of the two side motors (y)
  double b = 0.070;                               // middle motor behind the frame's origin (x)
  double c = 0.100;                               // middle motor away from the other half (z)
  double d = 0.030;                               // platform half width
  double h = 0.020;                               // platform height
  double a12 = 0.057;                             // origin of M to that of either structure
  std::array<double, 3> L1{0.155, 0.155, 0.205};  // upper arms, the same in both halves
  std::array<double, 3> L2{0.185, 0.185, 0.185};  // forearms
  double l_min = 0.14;                            // length at either end of the twist
  double l_max = 0.20;
  // Force between the ends per torque on the twist is 1 / (2 k) [m]. Loss-free screws have
  // k = (l_max - l_min) / (4 pi); set what was measured. Velocities always use the screws' pitch.
  double k = (0.20 - 0.14) / (4 * std::numbers::pi);
};
inline constexpr TwinDeltaGeometry kTwinDelta{};

struct TwinDeltaPose {
  Vec3 p_MH{0.18, 0, 0};
  Vec3 axis{0, 0, 1};  // in M, of unit length
  double length = 0.17;
};

// All angles of all legs; theta2 from the arm to the forearm in the leg's plane, theta3 out of it.
// theta1_other has every knee the other way. status is that of the first leg that fails
// (lateral_limit, too_far, too_close); the others are still solved. The length's own range is not
// looked at: see accepted().
struct TwinDeltaInverse {
  Status status = Status::not_finite;
  std::array<Status, 6> legs{status, status, status, status, status, status};
  Vec6 theta1 = Vec6::Zero(), theta2 = Vec6::Zero(), theta3 = Vec6::Zero();
  Vec6 theta1_other = Vec6::Zero();
};
TwinDeltaInverse inverse(const TwinDeltaGeometry& g, const TwinDeltaPose& pose) noexcept;

// The fast path: theta1 alone, one arctangent per leg. theta1 is zero unless status is ok.
struct TwinDeltaMotorAngles {
  Status status = Status::not_finite;
  Vec6 theta1 = Vec6::Zero();
};
TwinDeltaMotorAngles motor_angles(const TwinDeltaGeometry& g, const TwinDeltaPose& pose) noexcept;

// Forward kinematics, in closed form: either end is the working one of the two points where the
// spheres of its forearms meet. no_solution: they do not meet; singular: the ends coincide, or the
// centres of the spheres line up. The pose stays at its default unless status is ok.
struct TwinDeltaForward {
  Status status = Status::not_finite;
  TwinDeltaPose pose;
  Vec3 p_ME1 = Vec3::Zero(), p_ME2 = Vec3::Zero();
  Vec6 cos1 = Vec6::Zero(), sin1 = Vec6::Zero();  // of theta1, for jacobian()
};
TwinDeltaForward forward(const TwinDeltaGeometry& g, const Vec6& theta1) noexcept;
// The same in place, for every tick; unless status is ok the rest means nothing.
void solve_forward(const TwinDeltaGeometry& g, const Vec6& theta1, TwinDeltaForward& out) noexcept;

// theta2 and theta3 at a solved pose; zero if it is not. Only for display: no Jacobian needs them.
struct TwinDeltaPassiveAngles {
  Vec6 theta2 = Vec6::Zero(), theta3 = Vec6::Zero();
};
TwinDeltaPassiveAngles passive_angles(const TwinDeltaGeometry& g,
                                      const TwinDeltaForward& at) noexcept;

// Twist of the grip [rad], zero at mid stroke, in [-pi, pi] over the stroke; and back.
double twist_angle(const TwinDeltaGeometry& g, double length) noexcept;
double twist_length(const TwinDeltaGeometry& g, double gamma_c) noexcept;

// R_MG: columns x_h, y_h, z_h = axis, without a trigonometric call. Where the axis lies along X
// there is no x_h: previous_x_h is held, made square to the axis.
Mat3 handle_axes(const Vec3& axis, const Vec3& previous_x_h = Vec3(0, 0, -1)) noexcept;
// R_MH = R_MG Rz(gamma_c): what the hand holds.
Mat3 handle_rotation(const TwinDeltaGeometry& g, const Mat3& R_MG, double length) noexcept;

// For people to read; never to compute with: alpha, beta jump where the axis is level. alpha, beta
// are the axis projected on the YZ and XZ planes (eq. 20), alpha_e, beta_e those of
// R_MG = Rx(alpha_e) Ry(beta_e).
struct HandleAngles {
  double alpha = 0, beta = 0, alpha_e = 0, beta_e = 0;
};
HandleAngles handle_angles(const Vec3& axis) noexcept;
// The axis of projected angles within +-90 deg (eq. 21).
Vec3 axis_from_angles(double alpha, double beta) noexcept;

// Velocities and forces at a pose. Half 0 maps the velocity of E1 in M axes to the rates of motors
// 0, 1, 2; half 1 that of E2 in A2 axes to those of 3, 4, 5. Status: that of the kinematics, or
// singular (a stretched leg, or three forearms in a plane).
struct TwinDeltaJacobian {
  Status status = Status::not_finite;
  std::array<BarMap, 2> half{};
  Mat3 R_MG = Mat3::Identity();
  double length = 0;
  double k_force = 0;     // the geometry's k
  double k_velocity = 0;  // that of loss-free screws
};
TwinDeltaJacobian jacobian(const TwinDeltaGeometry& g, const TwinDeltaPose& pose,
                           const Mat3& R_MG) noexcept;
TwinDeltaJacobian jacobian(const TwinDeltaGeometry& g, const TwinDeltaForward& at,
                           const Mat3& R_MG) noexcept;

// Where forces may be commanded (reference section 5.6): for both halves the determinant of the
// unit forearm directions >= 0.15 and every lever |Jt| >= 0.02 m with its knee on the working side;
// the length in its range; |beta_e| <= 85 deg.
bool accepted(const TwinDeltaGeometry& g, const TwinDeltaJacobian& J) noexcept;

// Motor torques [N m] with which the handle pushes the hand with F_G. Zero if J is not ok or F_G is
// not finite. The 6x6 solve falls apart into the forces on E1 and E2 and two 3x3 solves.
Vec6 torque(const TwinDeltaJacobian& J, const Wrench& F_G) noexcept;
// The wrench of the handle on the hand; zero under the same conditions, as below.
Wrench wrench(const TwinDeltaJacobian& J, const Vec6& tau) noexcept;
Vec6 theta_rates(const TwinDeltaJacobian& J, const Twist& V_G) noexcept;
Twist velocity(const TwinDeltaJacobian& J, const Vec6& theta_rates) noexcept;

// Forces the user's side puts on the ends, E1 in M axes, E2 in A2 axes (how the sensors sit), and
// the same wrench: F_u = L F12 (eq. 34 with its errata).
struct EndForces {
  Vec3 f_E1_M = Vec3::Zero(), f_E2_A2 = Vec3::Zero();
};
EndForces end_forces(const TwinDeltaJacobian& J, const Wrench& F_G) noexcept;
Wrench wrench(const TwinDeltaJacobian& J, const EndForces& f) noexcept;

// Wrench on the hand that keeps the handle from leaving the accepted workspace: each edge pushes
// the end it belongs to; those of length and tilt push both ends against each other, half each,
// their margin being what either end moves. Zero if J is not ok.
Wrench edge_wrench(const TwinDeltaGeometry& g, const TwinDeltaForward& at,
                   const TwinDeltaJacobian& J, const WorkspaceEdge& edge) noexcept;

}  // namespace farhand
