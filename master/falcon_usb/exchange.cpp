#include "master/falcon_usb/exchange.hpp"

#include <algorithm>

namespace farhand::falcon_usb {

void Exchange::restart() noexcept {
  finder_.reset();
  owed_ = 0;
  waiting_ = false;
  slow_ = kSlow;
  asked_at_ = oldest_at_ = TimePoint::min();
}

TimePoint Exchange::free_at() const noexcept {
  if (asked_at_ == TimePoint::min()) return asked_at_;
  return waiting_ || slow_ > 0 ? asked_at_ + config_.answer_time : asked_at_;
}

void Exchange::asked(TimePoint now) noexcept {
  ++counters_.asked;
  if (waiting_) {
    ++counters_.unanswered;
    slow_ = kSlow;
  } else {
    owed_ = 0;  // what has not come since the last answer was lost
    // An answer that came twice looks like the next one: so the question before counts, too.
    if (oldest_at_ == TimePoint::min()) oldest_at_ = now;
    if (slow_ == 0) oldest_at_ = asked_at_;
    slow_ = std::max(0, slow_ - 1);
  }
  ++owed_;
  waiting_ = true;
  asked_at_ = now;
}

const Sample* Exchange::hear(std::span<const std::byte> bytes, TimePoint now) noexcept {
  std::uint64_t answers = 0;
  for (const std::byte b : bytes)
    if (const Packet* packet = finder_.take(b))
      if (const auto answer = decode_answer(*packet)) newest_.answer = *answer, ++answers;
  if (answers == 0) return nullptr;
  const std::uint64_t surplus = answers - std::min(answers, owed_);
  counters_.surplus += surplus;
  if (surplus > 0) slow_ = kSlow;
  if (owed_ == 0) return nullptr;
  owed_ -= answers - surplus;
  waiting_ = false;
  ++counters_.accepted;
  newest_.at = now;
  newest_.age = now - oldest_at_;
  return &newest_;
}

}  // namespace farhand::falcon_usb
