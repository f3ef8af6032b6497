// The compensation's part of a scene at the master; see build.hpp.
#pragma once

#include <optional>
#include <string>

#include "master/compensation/compensated_force.hpp"
#include "proto/scene.pb.h"

namespace farhand {

// Nothing without a compensation. Ts: period of the tick [s].
std::optional<CompensatedForceConfig> compensated_force(const proto::Scene& scene, double Ts);

// Its line among the stages; of what becomes of a late force where there is none.
std::string compensated_force_stage(const proto::Scene& scene);

}  // namespace farhand
