// From the robot's raw force/torque sensor to the wrench the robot exerts on its surroundings:
// constant bias and the force that carries the tool (against its weight) removed (reference section
// 8), optionally through one pole.
#pragma once

#include "common/geometry.hpp"

namespace farhand {

struct ForceSensingConfig {
  double tool_mass = 0;      // [kg] beyond the sensor
  Vec3 p_ET = Vec3::Zero();  // its centre of mass from E, E axes [m]
  Vec3 bias = Vec3::Zero();  // of the force reading, E axes [N]
  double cutoff_hz = 0;      // 0: no filter
  Vec3 gravity_S = Vec3(0, 0, -kGravity);
};

class ForceSensing {
 public:
  ForceSensing(const ForceSensingConfig& config, double Ts) noexcept;

  // raw: sensor reading at E, axes of S, bias and tool weight included. X_SE: pose of the tool. A
  // reading that is not plausible (common/limits.hpp): the last value.
  const Wrench& step(const Wrench& raw_E_S, const Pose& X_SE) noexcept;

 private:
  ForceSensingConfig config_;
  double gain_;
  bool primed_ = false;
  Wrench F_E_S_;
};

}  // namespace farhand
