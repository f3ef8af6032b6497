// What a compensation at the robot is given each tick, whichever method it is. All of it in the
// handle's terms, so that stiffness, mass and energy mean the same on both sides whatever the
// scales are.
#pragma once

#include "common/wire.hpp"

namespace farhand {

struct TargetInputs {
  const Pose& X_MT;             // the target, whoever limited it since the last tick
  const Pose& X_MR;             // the robot,
  const Twist& V_MR;            // measured
  const Wrench& F_E_M;          // robot on environment
  const MasterToSlave& handle;  // the newest message
  Duration age;                 // since it came
  Duration echo_age;            // of our own message that it answers
  TimePoint now{};              // of this tick
};

}  // namespace farhand
