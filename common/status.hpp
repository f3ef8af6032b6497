// Why a mechanism's function could not answer. Every solver returns one; none returns NaN.
#pragma once

#include <cstdint>

namespace farhand {

enum class Status : std::uint8_t {
  ok,
  not_finite,     // an input was NaN or infinite
  too_far,        // beyond the reach of a leg or of the arm
  too_close,      // inside the inner reach
  lateral_limit,  // a parallelogram or forearm cannot lean that far sideways
  no_solution,    // the parts do not meet, or only in an assembly that is not the working one
  singular,       // the map asked for does not exist here
  out_of_limits,  // solvable, but outside the accepted workspace or the joint limits
};

constexpr const char* to_string(Status s) noexcept {
  switch (s) {
    case Status::ok:
      return "ok";
    case Status::not_finite:
      return "not finite";
    case Status::too_far:
      return "too far";
    case Status::too_close:
      return "too close";
    case Status::lateral_limit:
      return "lateral limit";
    case Status::no_solution:
      return "no solution";
    case Status::singular:
      return "singular";
    case Status::out_of_limits:
      return "out of limits";
  }
  return "unknown";
}

}  // namespace farhand
