// The map of a scene's stability: where the wall becomes too stiff, over delay, reflection and
// mass.
#pragma once

#include "common/report/chart.hpp"
#include "tests/loop/stability/boundary.hpp"
#include "tests/loop/stability/grid.hpp"

namespace farhand {

// Largest stable wall stiffness of one axis over three other parameters, one panel each: a line as
// predicted, marks as found with the product's own loop, and the scene itself. Stable is below.
Chart stability_map(const Scene& scene, int surface);

// The grid's wall stiffness over the round trip: a panel per pair of masses, a line per gain as
// predicted, and a line of marks as simulated.
Chart grid_map(const std::vector<GridPoint>& points);

}  // namespace farhand
