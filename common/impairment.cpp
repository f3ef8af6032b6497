#include "common/impairment.hpp"

#include <algorithm>
#include <cmath>
#include <initializer_list>
#include <stdexcept>
#include <string>
#include <utility>

namespace farhand {
namespace {

using Values = std::initializer_list<std::pair<const char*, double>>;

void check(const Values& values, double least, double most) {
  for (const auto& [name, value] : values)
    if (!(value >= least && value <= most))
      throw std::invalid_argument(std::string("impairment: ") + name + " is " +
                                  std::to_string(value) + "; it must be from " +
                                  std::to_string(least) + " to " + std::to_string(most));
}

void check(const ImpairmentConfig& c) {
  check({{"loss_ratio", c.loss_ratio},
         {"burst_enter_ratio", c.burst_enter_ratio},
         {"burst_leave_ratio", c.burst_leave_ratio},
         {"burst_loss_ratio", c.burst_loss_ratio},
         {"duplicate_ratio", c.duplicate_ratio},
         {"reorder_ratio", c.reorder_ratio},
         {"corrupt_ratio", c.corrupt_ratio}},
        0, 1);
  check({{"delay_ms", c.delay_ms},
         {"jitter_ms", c.jitter_ms},
         {"reorder_hold_ms", c.reorder_hold_ms},
         {"spike_ms", c.spike_ms},
         {"step_ms", c.step_ms},
         {"step_at_s", c.step_at_s},
         {"step_length_s", c.step_length_s},
         {"cap_kbit_per_s", c.cap_kbit_per_s},
         {"cap_queue_bytes", c.cap_queue_bytes}},
        0, 1e6);
  check({{"spike_pause_s", c.spike_pause_s}}, 0.01, 1e6);
  check({{"cap_burst_bytes", c.cap_burst_bytes}}, 1, 1e6);
  check({{"delay_drift_ms_per_s", c.delay_drift_ms_per_s}}, -1e3, 1e3);
  for (const Blackout& b : c.blackouts)
    check({{"blackout.at_s", b.at_s},
           {"blackout.length_s", b.length_s},
           {"blackout.period_s", b.period_s}},
          0, 1e6);
}

ImpairmentConfig checked(const std::optional<ImpairmentConfig>& config) {
  if (!config) return {.delay_ms = 1e3 * seconds(Impairment::kPlainDelay)};
  check(*config);
  return *config;
}

}  // namespace

Impairment::Impairment(const std::optional<ImpairmentConfig>& config, std::uint64_t seed,
                       std::size_t capacity)
    : config_(checked(config)),
      fate_(seed),
      timing_(~seed),
      copy_timing_(seed ^ 0x5555555555555555),
      pauses_(seed ^ 0x3333333333333333),
      slots_(capacity),
      heap_(capacity) {
  for (std::size_t i = 0; i < capacity; ++i) heap_[i].slot = i;
}

bool Impairment::later(const Due& a, const Due& b) noexcept {
  return a.at != b.at ? a.at > b.at : a.order > b.order;
}

void Impairment::push(std::span<const std::byte> datagram, TimePoint now) noexcept {
  ++counters_.pushed;
  if (!begin_) begin_ = stall_ = now;
  const bool is_lost = lost();
  const bool twice = fate_.uniform() < config_.duplicate_ratio;
  const bool held_back = fate_.uniform() < config_.reorder_ratio;
  const bool corrupt = fate_.uniform() < config_.corrupt_ratio;
  const double where = fate_.uniform();
  const double jitter = jitter_ms(timing_), copy_jitter = jitter_ms(copy_timing_);
  const Duration stall = stalled(now);
  if (datagram.size() > kMaxDatagramBytes) {
    ++counters_.oversized;
    return;
  }
  if (blacked_out(now)) {
    ++counters_.blacked_out;
    return;
  }
  const auto leaves = through_cap(datagram.size(), now);
  if (!leaves) {
    ++counters_.capped;
    return;
  }
  if (is_lost) {
    ++counters_.lost;
    return;
  }
  std::optional<std::size_t> bit;
  if (corrupt && !datagram.empty()) {
    bit = static_cast<std::size_t>(where * 8 * static_cast<double>(datagram.size()));
    ++counters_.corrupted;
  }
  counters_.held_back += held_back;
  const double way = way_ms(now) + (held_back ? config_.reorder_hold_ms : 0);
  const auto due = [&](double more_ms) {
    return *leaves + stall + from_seconds(1e-3 * std::max(way + more_ms, 0.0));
  };
  schedule(datagram, due(jitter), bit);
  if (twice && waiting_ < heap_.size()) {
    ++counters_.duplicated;
    schedule(datagram, due(copy_jitter), bit);
  }
}

bool Impairment::lost() noexcept {
  const double random_loss = fate_.uniform(), change = fate_.uniform(), burst = fate_.uniform();
  in_burst_ = in_burst_ ? change >= config_.burst_leave_ratio : change < config_.burst_enter_ratio;
  return random_loss < config_.loss_ratio || (in_burst_ && burst < config_.burst_loss_ratio);
}

double Impairment::jitter_ms(Random& random) noexcept {
  switch (config_.jitter_kind) {
    case JitterKind::uniform:
      return config_.jitter_ms * (2 * random.uniform() - 1);
    case JitterKind::normal:
      return config_.jitter_ms * random.normal();
    case JitterKind::gamma:
      break;
  }
  const double u = 1 - random.uniform(), v = 1 - random.uniform();
  return config_.jitter_ms * -0.5 * std::log(u * v);
}

double Impairment::way_ms(TimePoint now) const noexcept {
  const double t = seconds(now - *begin_), stepped = t - config_.step_at_s;
  const bool step = stepped >= 0 && (config_.step_length_s == 0 || stepped < config_.step_length_s);
  return config_.delay_ms + config_.delay_drift_ms_per_s * t + (step ? config_.step_ms : 0);
}

bool Impairment::blacked_out(TimePoint now) const noexcept {
  for (const Blackout& b : config_.blackouts) {
    const Duration into = now - *begin_ - from_seconds(b.at_s), period = from_seconds(b.period_s);
    if (into < Duration::zero()) continue;
    if ((period > Duration::zero() ? into % period : into) < from_seconds(b.length_s)) return true;
  }
  return false;
}

std::optional<TimePoint> Impairment::through_cap(std::size_t bytes, TimePoint now) noexcept {
  if (config_.cap_kbit_per_s == 0) return now;
  const auto take = [&](double n) { return from_seconds(8e-3 * n / config_.cap_kbit_per_s); };
  const TimePoint full = std::max(bucket_full_, now) + take(static_cast<double>(bytes));
  const TimePoint leaves = std::max(now, full - take(config_.cap_burst_bytes));
  if (leaves - now > take(config_.cap_queue_bytes)) return std::nullopt;
  bucket_full_ = full;
  return leaves;
}

// Spikes come by the time, not by the datagram: seldom traffic meets the same ones.
Duration Impairment::stalled(TimePoint now) noexcept {
  if (config_.spike_ms == 0) return {};
  const Duration spike = from_seconds(1e-3 * config_.spike_ms);
  const auto pause = [&] {
    return from_seconds(-config_.spike_pause_s * std::log(1 - pauses_.uniform()));
  };
  if (stall_ == *begin_) stall_ += pause();
  while (now >= stall_ + spike) stall_ += spike + pause();
  return now < stall_ ? Duration::zero() : stall_ + spike - now;
}

void Impairment::schedule(std::span<const std::byte> datagram, TimePoint at,
                          std::optional<std::size_t> bit) noexcept {
  if (waiting_ == heap_.size()) {
    ++counters_.overflowed;
    return;
  }
  if (config_.keep_order) at = last_due_ = std::max(at, last_due_);
  Due& due = heap_[waiting_];
  Slot& slot = slots_[due.slot];
  std::copy(datagram.begin(), datagram.end(), slot.bytes.begin());
  slot.size = datagram.size();
  if (bit) slot.bytes[*bit / 8] ^= std::byte{1} << static_cast<int>(*bit % 8);
  due.at = at;
  due.order = order_++;
  ++waiting_;
  std::push_heap(heap_.begin(), heap_.begin() + static_cast<std::ptrdiff_t>(waiting_), later);
}

std::optional<TimePoint> Impairment::next_due() const noexcept {
  if (waiting_ == 0) return std::nullopt;
  return heap_.front().at;
}

std::span<const std::byte> Impairment::pop(TimePoint now, std::span<std::byte> out) noexcept {
  if (waiting_ == 0 || heap_.front().at > now) return {};
  std::pop_heap(heap_.begin(), heap_.begin() + static_cast<std::ptrdiff_t>(waiting_), later);
  --waiting_;
  ++counters_.popped;
  const Slot& slot = slots_[heap_[waiting_].slot];
  std::copy_n(slot.bytes.begin(), slot.size, out.begin());
  return out.first(slot.size);
}

}  // namespace farhand
