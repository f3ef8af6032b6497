#include "common/turn_sentence.hpp"

#include <spdlog/fmt/fmt.h>

#include <algorithm>
#include <numbers>

namespace farhand {
namespace {

std::string about(int axis, double angle) {
  // As the operator sees it: X points to him, Y to his right, Z up.
  constexpr const char* kWay[3][2] = {{"its top to the left", "its top to the right"},
                                      {"its top towards you", "its top away from you"},
                                      {"anticlockwise from above", "clockwise from above"}};
  const double degrees = std::max(1.0, std::abs(angle) * 180 / std::numbers::pi);
  return fmt::format("{:.0f} deg about {}{} ({})", degrees, angle < 0 ? '-' : '+', "xyz"[axis],
                     kWay[axis][angle < 0 ? 1 : 0]);
}

}  // namespace

std::string turn_sentence(const Vec3& turn_M) {
  const Vec3 size = turn_M.cwiseAbs();
  int first = 0;
  size.maxCoeff(&first);
  int second = (first + 1) % 3;
  if (size[(first + 2) % 3] > size[second]) second = (first + 2) % 3;
  std::string out = "turn the handle " + about(first, turn_M[first]);
  if (3 * size[second] >= size[first] && size[second] > 0)
    out += " and " + about(second, turn_M[second]);
  return out;
}

std::string sentence(Reason reason, const Vec3& turn_M) {
  if (reason != Reason::turn_handle) return to_string(reason);
  return turn_sentence(turn_M) + ", or press the clutch, dead-man released, to take it as it is";
}

std::string turning_line(Mode mode, Reason reason, const Vec3& turn_M) {
  return fmt::format(
      "{}: {}", to_string(mode),
      reason == Reason::turn_handle ? sentence(reason, turn_M) : turn_sentence(turn_M));
}

}  // namespace farhand
