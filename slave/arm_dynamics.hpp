// Rigid-body dynamics of the 6R arm (reference 7.1, 7.4): what the simulated robot is made of, and
// what a controller needs to carry the arm's weight.
//
// Link i turns with joint i; its body frame B_i has its origin at o_{i-1} and the axes of DH frame
// i-1 turned by Rz(q_i). From B_i to B_{i+1}: (a_i, 0, d_i), then Rx(alpha_i), then Rz(q_{i+1}).
// The twists alpha = (+90, 0, +90, -90, +90) deg and which lengths are zero are built in (spherical
// wrist, parallel joints 2 and 3); the lengths, inertias and gravity are not.
//
// Method: composite inertias for the mass matrix, Newton-Euler for the bias (Featherstone 2008,
// chapters 5 and 6) in body axes, where each transform is one plane rotation and a permutation.
#pragma once

#include <array>

#include "common/geometry.hpp"
#include "common/sincos.hpp"
#include "slave/arm.hpp"

namespace farhand {

struct LinkModel {
  double mass = 0;
  Vec3 com = Vec3::Zero();      // in the body frame
  Vec3 inertia = Vec3::Zero();  // Ixx, Iyy, Izz about the COM, body axes
  double torque_limit = 0;      // [N m], the joint's
  double coulomb = 0;           // [N m]
  double viscous = 0;           // [N m s]
};

// Lengths are the robot's own; everything else is assumed: a plausible 0.9 m, 7.3 kg arm.
struct ArmModel {
  ArmGeometry lengths;
  std::array<LinkModel, 6> links{
      {{2.0, {0, 0, 0.20}, {0.0120, 0.0120, 0.0040}, 60, 1.0, 0.5},    // assumed
       {2.2, {0.125, 0, 0}, {0.0040, 0.0140, 0.0140}, 60, 1.0, 0.5},   // assumed
       {1.2, {0, -0.06, 0}, {0.0040, 0.0020, 0.0040}, 40, 0.8, 0.4},   // assumed
       {1.0, {0, 0, 0.14}, {0.0040, 0.0040, 0.0012}, 15, 0.3, 0.1},    // assumed
       {0.5, {0, 0, 0}, {0.0008, 0.0008, 0.0006}, 15, 0.3, 0.1},       // assumed
       {0.4, {0, 0, 0.07}, {0.0006, 0.0006, 0.0003}, 8, 0.2, 0.05}}};  // assumed
  double armature = 0.01;                // reflected motor inertia on every joint, assumed
  Vec3 gravity = Vec3(0, 0, -kGravity);  // in S
};

// The model prepared for repeated use: inertia of each link about its body frame's origin.
struct LinkInertia {
  double mass = 0;
  double hx = 0, hy = 0, hz = 0;  // first moment, mass * com
  double xx = 0, yy = 0, zz = 0, xy = 0, xz = 0, yz = 0;
};
struct ArmDynamics {
  double d1 = 0, a2 = 0, d4 = 0, d6 = 0;
  std::array<LinkInertia, 6> links{};
  double armature = 0;
  Vec3 gravity = Vec3::Zero();
};
ArmDynamics make_arm_dynamics(const ArmModel& model) noexcept;

using JointTrig = SinCos<6>;
inline JointTrig joint_trig(const Vec6& q) noexcept {
  return sincos<6>(q.data());
}

// The six joint axes and a point on each, and the tool frame, in S.
struct ArmFrames {
  std::array<Vec3, 6> axis{};
  std::array<Vec3, 6> point{};
  Pose X_SE{};
};
ArmFrames arm_frames(const ArmDynamics& arm, const JointTrig& trig) noexcept;

// Velocity of the tool at E, S axes.
Twist tool_twist(const ArmFrames& frames, const Vec6& dq) noexcept;

// J^T F: joint torques [N m] equivalent to the wrench F that acts on the tool at E, S axes.
Vec6 joint_torques(const ArmFrames& frames, const Wrench& F_E_S) noexcept;

// M(q) [kg m^2], armature included; symmetric, both halves filled.
Mat6 mass_matrix(const ArmDynamics& arm, const Vec6& q) noexcept;

// Coriolis, centrifugal and gravity torques [N m]: tau = M ddq + bias.
Vec6 bias(const ArmDynamics& arm, const Vec6& q, const Vec6& dq) noexcept;

// Torques [N m] that hold the arm still against gravity.
Vec6 gravity_torques(const ArmDynamics& arm, const Vec6& q) noexcept;

// ddq [rad/s^2] = M^-1 (tau - bias). No joint friction; a caller adds it to tau. Non-finite input
// gives non-finite output, nothing else does: M is positive definite when armature > 0.
Vec6 forward_dynamics(const ArmDynamics& arm, const JointTrig& trig, const Vec6& dq,
                      const Vec6& tau) noexcept;

// The same with a wrench that the environment exerts on the tool at E, S axes.
Vec6 forward_dynamics(const ArmDynamics& arm, const Vec6& q, const Vec6& dq, const Vec6& tau,
                      const Wrench& F_E_S_external = {}) noexcept;

// Kinetic (armature included) plus potential energy [J]; the potential is zero with every COM at
// the height of S.
double energy(const ArmDynamics& arm, const Vec6& q, const Vec6& dq) noexcept;

}  // namespace farhand
