// What of a wall arrives at the hand, predicted and measured.
#pragma once

#include "tests/loop/stability/axis.hpp"

namespace farhand {

// Static, before the servo's integral has acted (it stiffens the servo within about 1 /
// integral_per_s to the whole wall): wall and servo are springs in series,
//
//   felt = scale force_scale / (1 / wall + 1 / servo),    servo = 1 / (g^T K^-1 g)
//
// with K the joints' kp (and the weight's slope where it is not compensated). The delay plays no
// part.
struct FeltStiffness {
  double wall = 0;   // [N/m]
  double servo = 0;  // [N/m], of the tool along the axis, held by the joints' springs
  double felt = 0;   // [N/m], at the handle
};
FeltStiffness felt_stiffness(const AxisModel& model);

// Of the product's own loop without friction: the motors' force over the handle's travel when the
// hand has moved 2 mm into a wall that holds the tool at its start, and come to rest there. The
// servo's integral is switched off. Throws if the motion has not come to rest.
double measured_felt_stiffness(const Scene& scene, int surface);

}  // namespace farhand
