// Feeds on the slave's records, off the loop: live line, warnings worth a sentence, and the final
// table.
#pragma once

#include <string>

#include "common/loop_watch.hpp"
#include "slave/loop.hpp"
#include "slave/summary.hpp"

namespace farhand {

// Rows of the final table that do not depend on real time: modes, tracking, limits.
std::string summary_rows(const SlaveSummary& summary);

class SlaveStatus {
 public:
  SlaveStatus(std::uint64_t scene_hash, bool quiet) : watch_(scene_hash, quiet) {}
  void add(const SlaveRecord& record);
  std::string final_table(std::uint64_t records_lost);

 private:
  LoopWatch watch_;
  SlaveSummary summary_;
};

}  // namespace farhand
