// What both sides' statuses do with a record besides their own figures: time by stage, changes of
// mode and a refused partner told in the log, and the live line, in whose place stands how the
// handle is to be turned while the robot waits for that; where there is no line, in the log.
#pragma once

#include <string>

#include "common/loop_report.hpp"
#include "common/mode.hpp"
#include "common/status_line.hpp"
#include "common/turn_sentence.hpp"

namespace farhand {

class LoopWatch {
 public:
  LoopWatch(std::uint64_t scene_hash, bool quiet)
      : scene_hash_(scene_hash), quiet_(quiet), line_(quiet) {}

  // tick: a MasterTick or a SlaveTick. When it is due, `make` builds the live line.
  template <typename Tick, typename MakeLine>
  void add(const Tick& tick, const LoopTiming& timing, const LinkStatus& link, MakeLine&& make) {
    const State s{tick.now, tick.mode, tick.reason, tick.turn_M};
    add(s, timing, link);
    const bool turning = must_be_turned(tick.mode, tick.reason, tick.aligned);
    if (!turning) turn_told_.clear();
    if (turning && quiet_) log_turn(s);
    if (line_.due(tick.now, turning))
      line_.show(turning ? turning_line(s.mode, s.reason, s.turn_M) : make());
  }
  const LoopReport& report() const noexcept { return report_; }
  // The last rows of the final table.
  std::string end(std::uint64_t records_lost);

 private:
  struct State {
    TimePoint now;
    Mode mode;
    Reason reason;
    Vec3 turn_M;
  };
  void add(const State& s, const LoopTiming& timing, const LinkStatus& link);
  void log_turn(const State& s);

  std::uint64_t scene_hash_;
  bool quiet_;
  StatusLine line_;
  LoopReport report_;
  Mode mode_ = Mode::disconnected;
  Reason reason_ = Reason::no_partner;
  PeerRefusal::Reason told_ = PeerRefusal::Reason::none;
  std::string turn_told_;
  TimePoint turn_next_{};
};

}  // namespace farhand
