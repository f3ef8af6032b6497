// Feeds on the master's records, off the loop: live line, warnings worth a sentence, and the final
// table.
#pragma once

#include <string>

#include "common/loop_report.hpp"
#include "common/status_line.hpp"
#include "master/loop.hpp"
#include "master/summary.hpp"

namespace farhand {

// Rows of the final table that do not depend on real time: modes, forces, position control, limits.
std::string summary_rows(const MasterSummary& summary);

class MasterStatus {
 public:
  MasterStatus(std::uint64_t scene_hash, bool quiet) : scene_hash_(scene_hash), line_(quiet) {}
  void add(const MasterRecord& record);
  std::string final_table(std::uint64_t records_lost);

 private:
  void watch_silence(const MasterRecord& record);

  std::uint64_t scene_hash_;
  StatusLine line_;
  MasterSummary summary_;
  LoopReport loop_;
  Mode mode_ = Mode::idle;
  TimePoint first_{};
  bool silence_told_ = false;
  PeerRefusal::Reason told_ = PeerRefusal::Reason::none;
};

}  // namespace farhand
