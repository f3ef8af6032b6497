// Values as a master's scene holds them, beyond those of common/scene_values.hpp.
#pragma once

#include "master/twin_delta.hpp"

namespace farhand {

// A repeated field of six numbers, x y z of the upper end's sensor, then of the lower's; zero when
// it is left out.
template <typename RepeatedField>
EndForces end_forces(const RepeatedField& v) {
  if (v.size() != 6) return {};
  return {{v.Get(0), v.Get(1), v.Get(2)}, {v.Get(3), v.Get(4), v.Get(5)}};
}

}  // namespace farhand
