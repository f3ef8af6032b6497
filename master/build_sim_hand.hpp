// The simulated hand's part of a scene; see build.hpp.
#pragma once

#include <optional>
#include <string>

#include "common/scene.hpp"
#include "master/sim_hand.hpp"

namespace farhand {

// Motor limit and seed are the caller's. `trace` replaces the motion; throws a sentence if nobody
// holds the handle.
SimHandConfig sim_hand_config(const Scene& scene, const std::optional<std::string>& trace);

}  // namespace farhand
