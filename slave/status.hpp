// Feeds on the slave's records, off the loop: live line, warnings worth a sentence, and the final
// table.
#pragma once

#include <string>

#include "common/loop_report.hpp"
#include "common/status_line.hpp"
#include "slave/loop.hpp"
#include "slave/summary.hpp"

namespace farhand {

// Rows of the final table that do not depend on real time: modes, tracking, limits.
std::string summary_rows(const SlaveSummary& summary);

class SlaveStatus {
 public:
  SlaveStatus(std::uint64_t scene_hash, bool quiet) : scene_hash_(scene_hash), line_(quiet) {}
  void add(const SlaveRecord& record);
  std::string final_table(std::uint64_t records_lost);

 private:
  std::uint64_t scene_hash_;
  StatusLine line_;
  SlaveSummary summary_;
  LoopReport loop_;
  Mode mode_ = Mode::idle;
  PeerRefusal::Reason told_ = PeerRefusal::Reason::none;
};

}  // namespace farhand
