// One question, one answer: when to ask the Falcon, and which answer is whose. Answers carry no
// number, so a late one looks like the next. What helps is that the line keeps order: after a loss
// the next questions are asked slowly, so that an answer nobody waits for shows itself.
#pragma once

#include <cstdint>
#include <span>

#include "common/time.hpp"
#include "master/falcon_usb/packet.hpp"

namespace farhand::falcon_usb {

struct ExchangeConfig {
  // Without an answer the question is asked again. Above what an exchange takes, 1.4 ms with the
  // chip's latency timer at 1 ms, and low enough that the second answer comes within 5 ms.
  Duration answer_time = std::chrono::milliseconds(2);
};

// An answer that arrived at `at` and was true at most `age` before, in the order of the line.
struct Sample {
  Answer answer;
  TimePoint at{};
  Duration age{};
};

struct ExchangeCounters {
  std::uint64_t asked = 0;
  std::uint64_t accepted = 0;
  std::uint64_t unanswered = 0;  // asked again
  std::uint64_t surplus = 0;     // answers nobody waited for, or with a newer one right behind
};

class Exchange {
 public:
  explicit Exchange(const ExchangeConfig& config = {}) noexcept : config_(config) {}

  // As if nothing had been asked; the counters stay.
  void restart() noexcept;

  // Whether the line is free for a question, and from when it is. The caller who asks says so.
  bool free(TimePoint now) const noexcept { return now >= free_at(); }
  TimePoint free_at() const noexcept;
  void asked(TimePoint now) noexcept;

  // The newest answer in bytes that arrived together; nullptr: none that was asked for. Valid until
  // the next call.
  const Sample* hear(std::span<const std::byte> bytes, TimePoint now) noexcept;

  const ExchangeCounters& counters() const noexcept { return counters_; }
  std::uint64_t skipped_bytes() const noexcept { return finder_.skipped(); }

 private:
  static constexpr int kSlow = 2;  // questions until the line is trusted again

  ExchangeConfig config_;
  PacketFinder finder_;
  std::uint64_t owed_ = 0;  // answers that may still come
  bool waiting_ = false;    // for one to the last question
  int slow_ = kSlow;
  TimePoint asked_at_ = TimePoint::min();
  TimePoint oldest_at_ = TimePoint::min();  // the question the next answer may belong to
  Sample newest_;
  ExchangeCounters counters_;
};

}  // namespace farhand::falcon_usb
