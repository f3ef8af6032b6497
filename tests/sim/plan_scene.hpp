// What a plan makes of a shipped scene: what was chosen within it, and a hand that moves all the
// time.
#pragma once

#include "common/scene.hpp"
#include "tests/sim/plan.hpp"

namespace farhand {

// The hand: a sine, where there is something to touch every 3 s forwards or back, and with
// alignment_deg turns away now and then while there are faults. Nothing is pressed.
Scene scene_of(const Plan& plan);

// As a scene names it; with `smith` the wall is the scene's.
void choose_method(Scene& scene, const std::string& method);

}  // namespace farhand
