// What no sensor should say.
#pragma once

#include <array>
#include <limits>

#include "common/geometry.hpp"
#include "common/random.hpp"

namespace farhand {

inline double senseless(Random& random) {
  constexpr std::array kValues = {std::numeric_limits<double>::quiet_NaN(),
                                  std::numeric_limits<double>::infinity(),
                                  -std::numeric_limits<double>::infinity(),
                                  std::numeric_limits<double>::max(),
                                  -1e300,
                                  1e30,
                                  std::numeric_limits<double>::denorm_min(),
                                  -1e-310,
                                  0.0};
  return kValues[random.bits() % kValues.size()];
}

// One element, whichever.
template <typename Vector>
void spoil(Random& random, Vector& v) {
  v[static_cast<Eigen::Index>(random.bits() % static_cast<std::uint64_t>(v.size()))] =
      senseless(random);
}

}  // namespace farhand
