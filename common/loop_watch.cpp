#include "common/loop_watch.hpp"

#include <spdlog/spdlog.h>

#include "common/summary_rows.hpp"

namespace farhand {
namespace {

constexpr Duration kTurnPace = std::chrono::seconds(1);

}  // namespace

void LoopWatch::add(const State& s, const LoopTiming& timing, const LinkStatus& link) {
  report_.add(timing, link);
  if (link.refusal.reason != told_) {
    told_ = link.refusal.reason;
    if (const auto sentence = refusal_sentence(link.refusal, scene_hash_); !sentence.empty())
      spdlog::error("{}", sentence);
  }
  if (s.mode == mode_ && s.reason == reason_) return;
  line_.end();
  const auto level = s.mode == Mode::fault ? spdlog::level::err : spdlog::level::info;
  const std::string why = sentence(s.reason, s.turn_M);
  const std::string from = s.mode == mode_ ? "" : fmt::format("{} -> ", to_string(mode_));
  spdlog::log(level, "{}{}{}{}", from, to_string(s.mode), why.empty() ? "" : ": ", why);
  mode_ = s.mode;
  reason_ = s.reason;
  if (s.reason != Reason::turn_handle) return;
  turn_told_ = turning_line(s.mode, s.reason, s.turn_M);
  turn_next_ = s.now + kTurnPace;
}

// At most once a second, and only what is new.
void LoopWatch::log_turn(const State& s) {
  if (s.now < turn_next_) return;
  turn_next_ = s.now + kTurnPace;
  std::string line = turning_line(s.mode, s.reason, s.turn_M);
  if (line == turn_told_) return;
  spdlog::info("{}", line);
  turn_told_ = std::move(line);
}

std::string LoopWatch::end(std::uint64_t records_lost) {
  line_.end();
  return report_.table() + lost_records_row(records_lost);
}

}  // namespace farhand
