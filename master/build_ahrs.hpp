// The AHRS of a scene: what the fusion knows of it, and where its samples come from.
#pragma once

#include <optional>
#include <string>

#include "master/ahrs/ahrs_line.hpp"
#include "master/ahrs/grip_motion.hpp"
#include "master/ahrs/sim_ahrs.hpp"
#include "proto/scene.pb.h"

namespace farhand {

GripMotionConfig grip_motion_config(const proto::Ahrs& ahrs, double Ts);
SimAhrsConfig sim_ahrs_config(const proto::Ahrs& ahrs);

// Opens the serial line, if the scene names one. Throws a sentence if it cannot be read.
void open_ahrs(const proto::Scene& scene, std::optional<AhrsLine>& line);

// Its line of the plan.
std::string ahrs_stage(const proto::Ahrs& ahrs);

}  // namespace farhand
