// What this program was built from and how, for recordings and reports.
#pragma once

#include <map>
#include <string>

namespace farhand {

// version, git_revision ("unknown" outside of a clone), compiler, flags.
const std::map<std::string, std::string>& build_info();

}  // namespace farhand
