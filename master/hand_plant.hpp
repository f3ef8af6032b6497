// The moving mass of the simulated handle and the hand on it: a point mass for the grip, a
// direction with two tilts, and a twist about it (reference section 9.3, in three dimensions):
//
//   (m_d + m_u) p'' = F_c - B p' - F_k tanh(|p'| / 0.005) p'/|p'| + weight + motors + push
//   F_c = k_u (p_d - p) + b_u (p_d' - p')         F_u = F_c + push - m_u p''
//
// and the same with moments for the tilts and the twist, where the hand has no inertia of its own:
// tilt spring k (axis x axis_d), that is k sin(angle); friction over 0.05 rad/s; twist without
// friction. F_u is what a force sensor between grip and device feels: the user on the device.
//
// Semi-implicit Euler: springs from the old position, dampers and friction by the new velocity,
// with friction's share of the speed taken at the old one. Friction can so only brake, at any step.
#pragma once

#include "common/geometry.hpp"

namespace farhand {

// The device, seen at the handle. No rotation_inertia: a point that only translates.
struct PlantConfig {
  double mass = 1.0;                // [kg] > 0
  double damping = 4;               // [N s/m]
  double friction = 0.8;            // [N]
  double weight = 2.0;              // [N] left after the counterbalance
  double rotation_inertia = 0.01;   // [kg m^2] > 0
  double rotation_damping = 0.02;   // [N m s]
  double rotation_friction = 0.02;  // [N m]
  double twist_inertia = 5e-4;      // [kg m^2] > 0
  double twist_damping = 2e-3;      // [N m s]
};

// The hand's spring and damper around its wish. All zero: nobody holds the grip.
struct HandImpedance {
  double mass = 0.4;              // [kg] moves with the grip, outside the sensor
  double stiffness = 500;         // [N/m]
  double damping = 20;            // [N s/m]
  double rotation_stiffness = 4;  // [N m/rad]
  double rotation_damping = 0.2;  // [N m s]
  double twist_stiffness = 0.5;   // [N m/rad]
  double twist_damping = 0.02;    // [N m s]
};
inline constexpr HandImpedance kNobody{0, 0, 0, 0, 0, 0, 0};

struct Plant {
  PlantConfig device;
  HandImpedance hand;
  Vec3 down_M = -Vec3::UnitZ();  // unit, where the weight pulls
  bool rotates = true;           // false: axis and twist stay as they are
};

template <typename T>
struct Course {
  T x;
  T rate;
};

// Where the handle is, or where the hand wants it: place of H, direction of the handle axis (unit)
// and its rate, twist about it; all in M.
struct HandCourse {
  Course<Vec3> p{Vec3::Zero(), Vec3::Zero()};
  Course<Vec3> axis{Vec3::UnitZ(), Vec3::Zero()};
  Course<double> twist{0, 0};
};

struct HandState {
  Vec3 p_MH = Vec3::Zero();
  Vec3 v_MH = Vec3::Zero();
  Vec3 axis_M = Vec3::UnitZ();  // of the handle, unit
  Vec3 omega_M = Vec3::Zero();  // of the axis, square to it [rad/s]
  double twist = 0;             // [rad] from mid stroke
  double twist_rate = 0;        // [rad/s]
};

// Force and tilting moment in M, and the moment of the twist.
struct HandLoad {
  Vec3 force = Vec3::Zero();
  Vec3 moment = Vec3::Zero();
  double twist = 0;
};

// One step of h seconds, h > 0. `wish` is the hand's at the end of the step, `motors` pushes the
// handle, `push` the grip from outside. Returns the load the user side put on the device (F_u).
HandLoad step(const Plant& plant, HandState& state, const HandCourse& wish, const HandLoad& motors,
              const Vec3& push, double h) noexcept;

// The largest angular frequency of the springs [rad/s]: steps up to 1 / this are accurate, up to
// 2 / this stable.
double fastest(const Plant& plant) noexcept;

// Kinetic energy and the weight's potential energy [J].
double energy(const Plant& plant, const HandState& state) noexcept;

}  // namespace farhand
