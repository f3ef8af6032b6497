#include "common/loop_watch.hpp"

#include <spdlog/spdlog.h>

#include "common/summary_rows.hpp"

namespace farhand {

void LoopWatch::add(Mode mode, const LoopTiming& timing, const LinkStatus& link) {
  report_.add(timing, link);
  if (link.refusal.reason != told_) {
    told_ = link.refusal.reason;
    if (const auto sentence = refusal_sentence(link.refusal, scene_hash_); !sentence.empty())
      spdlog::error("{}", sentence);
  }
  if (mode == mode_) return;
  line_.end();
  spdlog::info("{} -> {}", to_string(mode_), to_string(mode));
  mode_ = mode;
}

std::string LoopWatch::end(std::uint64_t records_lost) {
  line_.end();
  return report_.table() + lost_records_row(records_lost);
}

}  // namespace farhand
