// What the user's force does at the robot, where the master sends it (the force channels of a
// bilateral architecture). Either pushes the arm beside its position servo (four channels), or
// alone moves the target of a virtual mass (force-position).
#pragma once

#include "common/geometry.hpp"

namespace farhand {

// Feed-forward: tau = J^T F, F the share of the user's wrench, limited in size.
struct UserForceConfig {
  double share = 1;       // 0..1
  double max_force = 20;  // [N]
  double max_torque = 1;  // [N m]
};
// At E in axes of S; a non-finite wrench gives zero.
Wrench pushed(const UserForceConfig& config, const Wrench& F_user_S) noexcept;

// A mass with damping in the robot's place: M dv/dt = F_user - F_env - B v, and the same for
// rotation; its pose is the robot's target.
struct AdmittanceConfig {
  double Ts = 0.001;
  double mass = 2;                // [kg] > 0
  double damping = 10;            // [N s/m]
  double inertia = 0.02;          // [kg m^2] > 0
  double rotation_damping = 0.1;  // [N m s]
  double max_speed = 1;           // [m/s]
  double max_turn_rate = 6;       // [rad/s]
};

class Admittance {
 public:
  explicit Admittance(const AdmittanceConfig& config) noexcept : config_(config) {}

  // At rest. The next step starts from the pose it is given.
  void stop() noexcept { V_SE_ = {}; }

  // The target after this tick. F_user_S drives, F_env_S (robot on environment) resists, both at E
  // in axes of S. Semi-implicit, so damping never overshoots at any step. A wrench that is not
  // finite counts as zero. lock_rotation: the orientation stays.
  Pose step(const Pose& X_SE_target, const Wrench& F_user_S, const Wrench& F_env_S,
            bool lock_rotation) noexcept;

 private:
  AdmittanceConfig config_;
  Twist V_SE_;
};

}  // namespace farhand
