// What both sides' statuses do with a record besides their own figures: time by stage, changes of
// mode and a refused partner told in the log, and the live line, in whose place stands how the
// handle is to be turned while the robot waits for that.
#pragma once

#include <string>

#include "common/loop_report.hpp"
#include "common/mode.hpp"
#include "common/status_line.hpp"
#include "common/turn_sentence.hpp"

namespace farhand {

class LoopWatch {
 public:
  LoopWatch(std::uint64_t scene_hash, bool quiet) : scene_hash_(scene_hash), line_(quiet) {}

  // tick: a MasterTick or a SlaveTick. When it is due, `make` builds the live line.
  template <typename Tick, typename MakeLine>
  void add(const Tick& tick, const LoopTiming& timing, const LinkStatus& link, MakeLine&& make) {
    add(tick.mode, tick.reason, tick.turn_M, timing, link);
    const bool turning = must_be_turned(tick.mode, tick.reason, tick.aligned);
    if (line_.due(tick.now, turning))
      line_.show(turning ? turning_line(tick.mode, tick.reason, tick.turn_M) : make());
  }
  const LoopReport& report() const noexcept { return report_; }
  // The last rows of the final table.
  std::string end(std::uint64_t records_lost);

 private:
  void add(Mode mode, Reason reason, const Vec3& turn_M, const LoopTiming& timing,
           const LinkStatus& link);

  std::uint64_t scene_hash_;
  StatusLine line_;
  LoopReport report_;
  Mode mode_ = Mode::disconnected;
  Reason reason_ = Reason::no_partner;
  PeerRefusal::Reason told_ = PeerRefusal::Reason::none;
};

}  // namespace farhand
