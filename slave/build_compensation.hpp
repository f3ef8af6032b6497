// The compensation's part of a scene at the slave; see build.hpp.
#pragma once

#include <optional>
#include <string>

#include "proto/scene.pb.h"
#include "slave/slave.hpp"

namespace farhand {

// Nothing without a compensation. Of the slave's config: Ts and workspace.
std::optional<CompensatedTargetConfig> compensated_target(const proto::Scene& scene,
                                                          const SlaveConfig& slave);

// Its line among the stages, of a scene with one.
std::string compensated_target_stage(const proto::Scene& scene);

}  // namespace farhand
