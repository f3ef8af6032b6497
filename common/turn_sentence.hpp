// What an operator is told who must turn the handle (common/alignment.hpp).
#pragma once

#include <string>

#include "common/geometry.hpp"
#include "common/mode.hpp"

namespace farhand {

// turn_M: rotation vector [rad] in axes of M, as a twin delta has them. Names the axis it is mostly
// about; two if the second has at least a third of the first's angle. Whole degrees, at least 1:
//   turn the handle 12 deg about +x (its top to the left)
std::string turn_sentence(const Vec3& turn_M);

// Whether that is what the operator needs to see: the robot waits for it, or it will be asked for
// when the clutch is let go.
constexpr bool must_be_turned(Mode mode, Reason reason, bool aligned) noexcept {
  return reason == Reason::turn_handle || (mode == Mode::engaged && !aligned);
}

// Of a reason, with that in its place if it is turn_handle, and what else may be done. Empty for
// none.
std::string sentence(Reason reason, const Vec3& turn_M);

// The live line while it must be turned.
std::string turning_line(Mode mode, Reason reason, const Vec3& turn_M);

}  // namespace farhand
