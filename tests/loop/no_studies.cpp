#include "tests/loop/studies.hpp"

namespace farhand {

void Studies::add_to(Arguments&) {}
std::optional<int> Studies::run(const Scene*, bool) {
  return {};
}
std::vector<std::string> Studies::warnings(const Scene&) const {
  return {};
}

}  // namespace farhand
