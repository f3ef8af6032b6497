// A recording (MCAP) read once from its begin to its end into columns.
#pragma once

#include <functional>
#include <string>

#include "common/report/run_data.hpp"

namespace farhand {

// share: of the file read so far, 0 to 1; told every so often.
using Progress = std::function<void(double share)>;

// Throws std::runtime_error with a sentence if the file is no MCAP file or holds no tick. What is
// cut off or damaged is read as far as it goes, and told in RunData::notes.
RunData read_run(const std::string& path, const Progress& progress);

}  // namespace farhand
