// Feeds on the master's records, off the loop: live line, warnings worth a sentence, and the final
// table.
#pragma once

#include <string>

#include "common/loop_watch.hpp"
#include "master/loop.hpp"
#include "master/summary.hpp"

namespace farhand {

// Rows of the final table that do not depend on real time: modes, forces, position control, limits.
std::string summary_rows(const MasterSummary& summary);

class MasterStatus {
 public:
  MasterStatus(std::uint64_t scene_hash, bool quiet) : watch_(scene_hash, quiet) {}
  void add(const MasterRecord& record);
  void advise(const std::string& user);  // what the device asks of its user
  std::string final_table(std::uint64_t records_lost);

 private:
  void watch_silence(const MasterRecord& record);
  void watch_slave(const MasterRecord& record);
  void watch_method(const MasterRecord& record);
  void watch_ahrs(const MasterRecord& record);

  LoopWatch watch_;
  MasterSummary summary_;
  TimePoint first_{};
  bool silence_told_ = false;
  Reason slave_fault_ = Reason::none;
  const char* method_reason_ = nullptr;
  AhrsState ahrs_ = AhrsState::absent;
};

}  // namespace farhand
