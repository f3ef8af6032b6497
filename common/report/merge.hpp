// The master's and the slave's file of one run, as one.
#pragma once

#include <vector>

#include "common/report/run_data.hpp"

namespace farhand {

// Nanoseconds to add to the slave's log times to bring them to the master's clock: by the median
// clock offset the master measured, else the slave; 0 if neither did (the log times then rest on
// both machines' wall clocks).
std::int64_t shift_to_master(const RunData& master, const RunData& slave);

// Recordings with equal scene hashes, one of a master and one of a slave, whose times overlap once
// brought to the master's clock become one; the rest stays as it is. In the order of their first
// files. Times then count from the first tick of either side.
std::vector<RunData> merge_runs(std::vector<RunData> runs);

}  // namespace farhand
