// The same boundary found by running the product's own loop in virtual time.
#pragma once

#include "tests/loop/stability/boundary.hpp"

namespace farhand {

// The scene without what is not linear: no friction or weight of the handle, in it or in the
// controller's model, no friction of the arm (nor its compensation), ideal encoders and sensors, a
// network of constant delay, the handle's limits open, contact damping always there (a constant
// force of 2 mN along the wall keeps the handle in touch). The wall becomes two, of half its
// stiffness each, that face each other and overlap by 0.2 m with the tool in their middle: a wall
// that pulls as it pushes, force-free where the robot starts. The hand presses the dead-man, rests,
// and is nudged with a thousandth of a newton along the axis.
Scene linear_scene(const Scene& scene, int surface);

// Rate [1/s] at which the speeds of handle and tool along the axis grow after the nudge (negative:
// they die away): slope of the logarithm of their envelope, once the quick modes are gone. Runs
// until that is certain, or for `longest_s` of virtual time.
double growth_rate(const Scene& linear, double longest_s = 8);

// Where growth begins, to 0.5 %, bracketed by runs on both sides. Walks outwards from `guess`,
// which so decides only how many runs it takes. 0: no boundary within a factor of ten.
double simulated_limit(const Scene& scene, int surface, Parameter parameter, double guess);

// The scene with everything it has, its wall one-sided, made a plane 2 mm before the tool: the hand
// moves against it within a second so as to press with kPress at rest, and holds. `knock`: half a
// sine of 50 ms and so many newtons towards the wall, a second later.
inline constexpr double kPress = 3, kKnock = 10;    // [N]
inline constexpr double kPressed = 2, kJudged = 6;  // [s]
Scene pressing_scene(const Scene& scene, int surface, double knock = 0);
// The handle still moves with more than 5 mm/s rms from kJudged on. Not the tool: the steps of the
// handle's encoders alone shake it that much.
bool chatters(const Scene& pressing);
// From where on it does, to 5 %. 0: at every value down to a tenth of the guess; infinity: at none
// up to ten times.
double chatter_limit(const Scene& scene, int surface, Parameter parameter, double guess,
                     double knock = 0);

}  // namespace farhand
