// One axis of a scene as numbers: the hand and device that move along it, the arm seen along it,
// and everything between. What the linear analysis is made of; every number comes from the scene
// through the product's own builders.
//
// The axis runs into a wall: against the outward normal of a surface where the tool is nearest to
// it at its start pose. A point contact without friction neither turns the tool nor pulls it
// sideways, and the simulated hand is the same in all directions, so this axis moves alone.
#pragma once

#include <optional>
#include <vector>

#include "common/pid.hpp"
#include "common/scene.hpp"
#include "common/time.hpp"
#include "master/hand_plant.hpp"
#include "slave/joint_servo.hpp"
#include "tests/loop/stability/axis_device.hpp"

namespace farhand {

// The arm at its start pose, linearised, without the friction of its gears:
// M ddq + K_g dq = tau - g F, with F the force of the tool on the wall along the axis.
struct ArmAxis {
  Mat6 M = Mat6::Identity();  // [kg m^2]
  Mat6 K_g = Mat6::Zero();    // slope of the weight's torques [N m/rad]
  Vec6 g = Vec6::Zero();      // J^T a: joint torques per newton, tool motion per radian [m]
  Vec6 c = Vec6::Zero();      // joint command per metre of commanded tool motion [rad/m]
  double rate_hz = 1000;      // of the integration
  JointServoConfig servo;     // its friction compensation is not looked at
};

struct HandAxis {
  PlantConfig device;  // friction and weight are not looked at
  HandImpedance hand;
  double rate_hz = 5000;  // of the integration
};

// The master's force controller on this axis, reference sections 4 and 9.1.
struct AxisForceLoop {
  PidConfig gains;            // [N/N], [1/s], [s]
  double cutoff_hz = 0;       // of the pole before it; 0: none
  bool filter_error = false;  // the pole acts on F_u - F_e instead of on F_u
};

struct WallAxis {
  double stiffness = 0;  // [N/m]
  double damping = 0;    // [N s/m]
};

struct AxisModel {
  double Ts = 0.001;
  HandAxis hand;
  ArmAxis arm;
  WallAxis wall;
  bool reflects = false;               // the scene has force feedback
  std::optional<AxisForceLoop> force;  // without: open-loop reflection
  std::optional<AxisDevice> device;    // stages that know its model
  double scale = 1;                    // handle to tool
  double force_scale = 1;              // tool to handle
  double sensing_cutoff_hz = 0;        // of the robot's force sensor; 0: no filter
  Duration to_slave{}, to_master{};    // the network's mean delays
  Duration cut_off{};                  // of the master's wait
  Vec3 axis_S = Vec3::UnitY();         // into the wall
  Vec3 axis_M = Vec3::UnitX();
};

// Axes to analyse: one per surface of the simulated arm. Throws with a sentence if there is none,
// no simulated hand or arm to be analysed, or a bilateral architecture other than position-force.
int surfaces(const Scene& scene);
AxisModel axis_model(const Scene& scene, int surface);

// (kp + 2 kd/Ts) m_u / (m_d + m_u), to be below 1 (reference section 9.2): sufficient for the local
// loop of hand, device and force controller without its filter.
double small_gain(const AxisModel& model) noexcept;

}  // namespace farhand
