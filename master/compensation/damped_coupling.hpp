// P+d at the handle (common/damped.hpp) in six axes: translation is one port, rotation another,
// tilt and twist with stiffnesses of their own, since the twist's motors can render less. Each port
// under a guard of its own (common/force_guard.hpp). Takes the place of the contact force that is
// reflected without compensation.
#pragma once

#include "common/damped.hpp"
#include "common/guarded_port.hpp"
#include "common/ports.hpp"
#include "common/wire.hpp"
#include "master/compensation/damped.hpp"
#include "master/handle.hpp"

namespace farhand {

struct DampedCouplingConfig {
  bool rotation = true;  // false: translation alone, no torque
  DampedConfig translation;
  DampedConfig tilt{.stiffness = 1, .max_damping = 0.02};
  DampedConfig twist{.stiffness = 0.2, .max_damping = 0.003};
  double max_force = 20,
         max_torque = 1;  // [N], [N m] that the hand may feel: the guard must see it
  ForceGuardConfig guard;
  ForceGuardConfig rotation_guard{.store = 0.005, .reserve = 0.001, .max_damping = 0.02};
};

class DampedCoupling {
 public:
  explicit DampedCoupling(const DampedCouplingConfig& config) noexcept;

  // Handle on coupling, G axes, faded by the message's age (`age_share`; back in slowly). Without
  // the robot's pose in the message only the dampers act. echo_age: of our own message that the
  // robot's answers.
  Wrench step(const HandlePose& handle, const Twist& V_MH, const SlaveToMaster& robot,
              Duration echo_age, double age_share) noexcept;
  // In a tick in which nothing of it is felt.
  void let_go() noexcept;

  PortEnergies told() const noexcept { return {translation_.told(), rotation_.told()}; }

 private:
  Vec3 torque(const HandlePose& handle, const Twist& V_MH, const SlaveToMaster& robot,
              Duration echo_age) noexcept;

  bool rotates_;
  double max_force_, max_torque_;
  double Ts_;
  FadeIn fade_in_;
  DampedMaster spring_, tilt_, twist_;
  GuardedPort translation_, rotation_;
  bool turning_ = false;
  Mat3 R_ = Mat3::Identity();
  Vec3 turned_ = Vec3::Zero();  // of the handle in M axes, added up
};

}  // namespace farhand
