// Kinematics of the serial arm: six revolute joints, spherical wrist (reference section 7).
//
// Standard DH, T_i = Rz(q_i) Tz(d_i) Tx(a_i) Rx(alpha_i):
//
//   i      1    2    3    4    5    6        Axis 1 is the vertical of the base S. Joints 2 and 3
//   a      0   a2    0    0    0    0        move the wrist centre in a vertical plane; axes 4, 5
//   alpha 90    0   90  -90   90    0 deg    and 6 meet in it, and the tool E stands d6 beyond it
//   d     d1    0    0   d4    0   d6        on axis 6.
//
// Eight configurations reach a pose: wrist centre in front of or behind axis 1 (shoulder, the sign
// of r = a2 cos q2 + d4 sin(q2 + q3)), elbow on either side (the sign of cos q3), wrist as it is or
// flipped (the sign of q5). Each sign changes in a singularity of its own: det J = -a2 d4 r cos q3
// sin q5.
//
// Angles in rad, lengths in m. Nothing here allocates, throws or keeps a state.
#pragma once

#include <array>
#include <numbers>

#include "common/geometry.hpp"
#include "common/status.hpp"

namespace farhand {

// a2, d4 > 0.
struct ArmGeometry {
  double d1 = 0.26;  // base to shoulder, up
  double a2 = 0.25;  // shoulder to elbow
  double d4 = 0.24;  // elbow to wrist centre
  double d6 = 0.14;  // wrist centre to tool
};

inline Vec6 joints_from_degrees(const std::array<double, 6>& q) noexcept {
  return Eigen::Map<const Vec6>(q.data()) * (std::numbers::pi / 180);
}

struct JointLimits {
  Vec6 lower = joints_from_degrees({-80, -20, -120, -180, -120, -360});
  Vec6 upper = joints_from_degrees({260, 200, 120, 180, 120, 360});
  Vec6 speed = joints_from_degrees({180, 180, 180, 360, 360, 360});  // [rad/s], > 0
};

// Where teleoperation starts: tool level and forward along Y, far from every singularity.
inline const Vec6 kTeleopHome = joints_from_degrees({90, 95, -35, 0, 30, 0});

// Distance from the three singularities, each in its own terms: a single condition number would
// mix metres with radians and not say which joints are about to run away.
struct ArmSingularity {
  double wrist = 0;     // |sin q5|
  double elbow = 0;     // |cos q3|
  double shoulder = 0;  // |r| [m], wrist centre from axis 1
};

// Geometric Jacobian at the tool point, in S axes: column i is what joint i alone, at 1 rad/s, does
// to the tool. Two named blocks, so that no caller relies on the order of six rows.
struct ArmJacobian {
  Eigen::Matrix<double, 3, 6> linear = Eigen::Matrix<double, 3, 6>::Zero();   // [m]
  Eigen::Matrix<double, 3, 6> angular = Eigen::Matrix<double, 3, 6>::Zero();  // the joint axes
};

// What a control tick needs of one joint vector, from one sine and cosine per joint.
struct ArmKinematics {
  Status status = Status::not_finite;  // ok, or not_finite and everything else as initialised
  Pose X_SE = {};
  ArmJacobian J = {};
  ArmSingularity singularity = {};
  Vec3 p_S_elbow = Vec3::Zero();
  Vec3 p_S_wrist = Vec3::Zero();         // the wrist centre
  double r = 0, cos_q3 = 0, sin_q5 = 0;  // with their signs: the branch
};

// Tool pose X_SE, to about 7e-16, and the Jacobian alone. A non-finite q gives non-finite numbers;
// kinematics() reports it.
Pose forward(const ArmGeometry& geometry, const Vec6& q) noexcept;
ArmJacobian jacobian(const ArmGeometry& geometry, const Vec6& q) noexcept;
ArmKinematics kinematics(const ArmGeometry& geometry, const Vec6& q) noexcept;

// Torques [N m] with which the robot exerts F_E_S (at the tool point, S axes) on what it touches:
// tau = J^T [F; M].
Vec6 joint_torques(const ArmJacobian& J, const Wrench& F_E_S) noexcept;

// Velocity of the tool point and of the tool, in S axes.
Twist tool_twist(const ArmJacobian& J, const Vec6& dq) noexcept;

// The rates that move the tool with V_E_S. Solved through the wrist centre, in closed form: joints
// 1 to 3 move it, 4 to 6 then turn the tool. `singular` and zero rates where a measure of
// ArmSingularity is below 1e-12; `not_finite` and zero rates on bad input. Rates are not limited
// here.
struct JointRates {
  Status status = Status::not_finite;
  Vec6 dq = Vec6::Zero();
};
JointRates joint_rates(const ArmGeometry& geometry, const ArmKinematics& at,
                       const Twist& V_E_S) noexcept;

// Signs +1 or -1, as described at the top; all +1 at kTeleopHome.
struct ArmBranch {
  int shoulder = 1;
  int elbow = 1;
  int wrist = 1;
};
// Its place among the eight rows: +++ ++- +-+ +-- -++ -+- --+ ---.
constexpr int row_of(const ArmBranch& b) noexcept {
  return (b.shoulder < 0 ? 4 : 0) + (b.elbow < 0 ? 2 : 0) + (b.wrist < 0 ? 1 : 0);
}

// All eight configurations of a pose, rows in the order of row_of, each angle in (-pi, pi]; limits
// are not looked at. The regular formulas are used right up to the singularities and keep 1e-15 m
// there. In one to rounding, what the pose leaves open is taken from q_previous: q1 when the wrist
// centre is within 5e-16 m of axis 1, q4 when axes 4 and 6 are in line within 2e-15 rad; the rows
// on both sides then coincide.
//
// Not ok: too_far or too_close (the wrist centre misses its shell [|a2 - d4|, a2 + d4] about the
// shoulder by `miss` > 1e-12 m; less than that is taken as the edge), not_finite, no_solution (X_SE
// is not a rotation to 1e-9, or a2 or d4 is not positive). The rows are then zero.
struct ArmInverse {
  Status status = Status::not_finite;
  double miss = 0;  // [m], 0 when reachable
  std::array<Vec6, 8> rows{Vec6::Zero(), Vec6::Zero(), Vec6::Zero(), Vec6::Zero(),
                           Vec6::Zero(), Vec6::Zero(), Vec6::Zero(), Vec6::Zero()};
};
ArmInverse inverse_all(const ArmGeometry& geometry, const Pose& X_SE,
                       const Vec6& q_previous) noexcept;

// The configuration that continues the motion from q_previous. The elbow stays that of q_previous,
// and so does the shoulder, unless the wrist centre is within 25 mm of axis 1 before and after:
// there the shoulder with the nearer q1 is taken, so that the wrist passes over the axis without a
// half turn of q1. Of the two wrists the one sooner reached at full speed is taken, so q5 passes
// through 0 without a half turn of q4 and q6. Angles are unwrapped to be within half a turn of
// q_previous.
//
// Status as inverse_all, and out_of_limits: a continuation outside the limits is refused, never
// replaced by a leap to another turn or wrist (only by the other wrist when that is within a tenth
// as near); up to 1e-12 rad outside is rounding and put on the
// limit. When not ok, q is q_previous (zero if that is not finite): holding it is the answer.
struct ArmNearest {
  Status status = Status::not_finite;
  Vec6 q = Vec6::Zero();
  ArmBranch branch = {};
  double miss = 0;                  // as above
  ArmSingularity singularity = {};  // of the solution, also when it is out of limits
};
ArmNearest inverse(const ArmGeometry& geometry, const JointLimits& limits, const Pose& X_SE,
                   const Vec6& q_previous) noexcept;

}  // namespace farhand
