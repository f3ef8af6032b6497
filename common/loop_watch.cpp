#include "common/loop_watch.hpp"

#include <spdlog/spdlog.h>

#include "common/summary_rows.hpp"

namespace farhand {

void LoopWatch::add(Mode mode, Reason reason, const Vec3& turn_M, const LoopTiming& timing,
                    const LinkStatus& link) {
  report_.add(timing, link);
  if (link.refusal.reason != told_) {
    told_ = link.refusal.reason;
    if (const auto sentence = refusal_sentence(link.refusal, scene_hash_); !sentence.empty())
      spdlog::error("{}", sentence);
  }
  if (mode == mode_ && reason == reason_) return;
  line_.end();
  const auto level = mode == Mode::fault ? spdlog::level::err : spdlog::level::info;
  const std::string why = sentence(reason, turn_M);
  const std::string from = mode == mode_ ? "" : fmt::format("{} -> ", to_string(mode_));
  spdlog::log(level, "{}{}{}{}", from, to_string(mode), why.empty() ? "" : ": ", why);
  mode_ = mode;
  reason_ = reason;
}

std::string LoopWatch::end(std::uint64_t records_lost) {
  line_.end();
  return report_.table() + lost_records_row(records_lost);
}

}  // namespace farhand
