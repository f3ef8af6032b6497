// A buffer that trades delay for even arrival: a value sent at t comes out at t + least transit +
// D, on the sender's time scale, so no common clock is needed. D is the jitter that all but a share
// of the messages stay within, over the last seconds. It grows at once when messages come late in
// numbers; otherwise time is stretched or squeezed by 1 %, never jumped but to where a use begins.
// Where far more than D is waited, since the way got shorter, it is squeezed more.
//
// Jitter is counted from the least transit of that time. When that rises, by a longer way or a
// clock that was set, what was late is less so; when it falls, what was late before is no jitter.
//
// Between messages values are interpolated, so a lost one costs nothing, and neither does one that
// was overtaken: at 1 kHz those that overtake come early, and D is theirs. After the newest it
// holds. Duplicates and an unknown offset of the clocks do not matter.
#pragma once

#include <algorithm>
#include <array>
#include <cstddef>

#include "common/recent_histogram.hpp"
#include "common/recent_minimum.hpp"
#include "common/time.hpp"

namespace farhand {

struct PlayoutConfig {
  double late_share = 0.01;  // of messages that may come after their time
  double memory = 2;         // [s] over which jitter is remembered
  double slew = 0.01;        // of real time
  double most = 0.25;        // [s] of D
};

// When to play: from transit times alone.
class PlayoutClock {
 public:
  explicit PlayoutClock(const PlayoutConfig& config) noexcept
      : config_(config),
        base_(from_seconds(config.memory)),
        lateness_(from_seconds(config.memory)) {}

  // Of every message used; both stamps since their clocks' epochs.
  void arrived(Duration sent, Duration now) noexcept {
    base_.add(now, now - sent);
    rebase();
    const double late = seconds(now - sent - least_);
    lateness_.add(now, static_cast<std::size_t>(std::max(late / kBin, 0.0)));
    late_score_ += (started_ && sent < played_ ? 1.0 : 0.0) - late_score_ / 100;
  }

  // Once per tick: the sender's time to be played now. Never runs backwards.
  Duration play(Duration now) noexcept {
    if (base_.empty()) return played_;
    const double jitter = kBin * static_cast<double>(lateness_.most(config_.late_share));
    const double wish = seconds(least_) + std::min(jitter, config_.most);
    if (late_score_ >= 3) offset_ = std::max(offset_, wish);
    if (late_score_ >= 3) late_score_ = 0;
    if (!settled_) offset_ = wish;
    settled_ = true;
    const double most = started_ ? config_.slew * seconds(now - last_) : 0;
    const double surplus = std::max(offset_ - wish, 0.0) / config_.memory * seconds(now - last_);
    offset_ += std::clamp(wish - offset_, -most - surplus, most);
    last_ = now;
    const Duration at = now - from_seconds(offset_);
    played_ = started_ ? std::max(played_, at) : at;
    started_ = true;
    return played_;
  }
  Duration played() const noexcept { return played_; }
  // The next time to be played is what is right now, however far from the last one.
  void settle() noexcept { settled_ = false; }
  // D [s], as played.
  double delay() const noexcept { return base_.empty() ? 0 : offset_ - seconds(least_); }

 private:
  static constexpr double kBin = 0.001;

  // least_ follows the least transit, up by whole bins.
  void rebase() noexcept {
    const Duration bin = from_seconds(kBin), rise = base_.minimum() - least_;
    if (rise < Duration::zero() || lateness_.empty()) least_ = base_.minimum();
    if (rise < bin || lateness_.empty()) return;
    least_ += rise / bin * bin;
    lateness_.lower(static_cast<std::size_t>(rise / bin));
  }

  PlayoutConfig config_;
  RecentMinimum base_;
  Duration least_{};  // transit that jitter is counted from
  RecentHistogram lateness_;
  double late_score_ = 0, offset_ = 0;
  bool started_ = false, settled_ = false;
  Duration last_{}, played_{};
};

// Value: needs + and -, and * with a double from the left.
template <typename Value>
class Playout {
 public:
  explicit Playout(const PlayoutConfig& config) noexcept : clock_(config) {}

  // Of any message; one that is not newer than all before is passed over.
  void push(Duration sent, const Value& value, Duration now) noexcept {
    if (size_ > 0 && sent <= at(size_ - 1).sent) return;
    clock_.arrived(sent, now);
    if (size_ == kCapacity) first_ = (first_ + 1) % kCapacity, --size_;
    at(size_++) = {sent, value};
  }

  // What is to be used now; `before` until the first message.
  Value play(Duration now, const Value& before = {}) noexcept {
    const Duration t = clock_.play(now);
    while (size_ > 1 && at(1).sent <= t) first_ = (first_ + 1) % kCapacity, --size_;
    if (size_ == 0) return before;
    const Entry& a = at(0);
    if (size_ == 1 || t <= a.sent) return a.value;
    const Entry& b = at(1);
    return a.value + (seconds(t - a.sent) / seconds(b.sent - a.sent)) * (b.value - a.value);
  }
  // Pushed last.
  Value newest(const Value& before = {}) const noexcept {
    return size_ > 0 ? at(size_ - 1).value : before;
  }
  // A use begins: how late things were in another one does not count.
  void settle() noexcept { clock_.settle(); }
  // The same, and what came before the newest is not played any more.
  void skip_to_newest() noexcept {
    settle();
    if (size_ > 1) first_ = (first_ + size_ - 1) % kCapacity, size_ = 1;
  }
  double delay() const noexcept { return clock_.delay(); }
  // When what was given out last was sent, by the sender's time: no later than the newest.
  Duration given() const noexcept {
    return size_ > 0 ? std::clamp(clock_.played(), at(0).sent, at(size_ - 1).sent)
                     : clock_.played();
  }

 private:
  static constexpr std::size_t kCapacity = 512;  // half a second at 1 kHz
  struct Entry {
    Duration sent{};
    Value value{};
  };
  Entry& at(std::size_t i) noexcept { return ring_[(first_ + i) % kCapacity]; }
  const Entry& at(std::size_t i) const noexcept { return ring_[(first_ + i) % kCapacity]; }

  PlayoutClock clock_;
  std::array<Entry, kCapacity> ring_{};
  std::size_t first_ = 0, size_ = 0;
};

}  // namespace farhand
