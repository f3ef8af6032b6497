// The report as a whole: from runs to a page.
#pragma once

#include <string>
#include <vector>

#include "common/report/run_data.hpp"

namespace farhand {

// What a run is called among the others: its file's name without folder and suffix.
std::vector<std::string> names_of(const std::vector<RunData>& runs);

// At least one run.
std::string report_html(const std::vector<RunData>& runs);
std::string report_json(const std::vector<RunData>& runs);

}  // namespace farhand
