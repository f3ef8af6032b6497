// From a checked scene to the master's parts. What the scene leaves out is not built.
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "common/scene.hpp"
#include "master/devices.hpp"
#include "master/loop.hpp"
#include "master/master.hpp"

namespace farhand {

MasterConfig master_config(const proto::Scene& scene);
MasterLoopConfig master_loop_config(const proto::Scene& scene);

// `trace` replaces the simulated hand's motion by a recorded one. Throws a sentence if the scene
// has no hand for it or the file is no good.
AnyDevice make_device(const Scene& scene, const std::optional<std::string>& trace,
                      std::uint64_t seed);

// One line per stage the master will run, in order.
std::vector<std::string> master_stages(const proto::Scene& scene);

}  // namespace farhand
