// What both sides' statuses do with a record besides their own figures: time by stage, changes of
// mode and a refused partner told in the log, and the live line.
#pragma once

#include <string>

#include "common/loop_report.hpp"
#include "common/mode.hpp"
#include "common/status_line.hpp"

namespace farhand {

class LoopWatch {
 public:
  LoopWatch(std::uint64_t scene_hash, bool quiet) : scene_hash_(scene_hash), line_(quiet) {}

  void add(Mode mode, Reason reason, const LoopTiming& timing, const LinkStatus& link);
  // Once a second `make` builds the live line.
  template <typename MakeLine>
  void live(TimePoint now, MakeLine&& make) {
    if (line_.due(now)) line_.show(make());
  }
  const LoopReport& report() const noexcept { return report_; }
  // The last rows of the final table.
  std::string end(std::uint64_t records_lost);

 private:
  std::uint64_t scene_hash_;
  StatusLine line_;
  LoopReport report_;
  Mode mode_ = Mode::disconnected;
  Reason reason_ = Reason::no_partner;
  PeerRefusal::Reason told_ = PeerRefusal::Reason::none;
};

}  // namespace farhand
