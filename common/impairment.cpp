#include "common/impairment.hpp"

#include <algorithm>
#include <cmath>
#include <stdexcept>
#include <string>

namespace farhand {
namespace {

void check(const ImpairmentConfig& c) {
  const std::pair<const char*, double> ratios[] = {{"loss_ratio", c.loss_ratio},
                                                   {"burst_enter_ratio", c.burst_enter_ratio},
                                                   {"burst_leave_ratio", c.burst_leave_ratio},
                                                   {"burst_loss_ratio", c.burst_loss_ratio},
                                                   {"duplicate_ratio", c.duplicate_ratio},
                                                   {"reorder_ratio", c.reorder_ratio},
                                                   {"corrupt_ratio", c.corrupt_ratio}};
  for (const auto& [name, value] : ratios)
    if (!(value >= 0 && value <= 1))
      throw std::invalid_argument(std::string("impairment: ") + name + " is " +
                                  std::to_string(value) + "; it must be from 0 to 1");
  const std::pair<const char*, double> times[] = {
      {"delay_ms", c.delay_ms}, {"jitter_ms", c.jitter_ms}, {"reorder_hold_ms", c.reorder_hold_ms}};
  constexpr double kLongestMs = 1e6;
  for (const auto& [name, value] : times)
    if (!(value >= 0 && value <= kLongestMs))
      throw std::invalid_argument(std::string("impairment: ") + name + " is " +
                                  std::to_string(value) + "; it must be from 0 to 1000000");
}

ImpairmentConfig checked(const std::optional<ImpairmentConfig>& config) {
  if (!config) return {.delay_ms = 1e3 * seconds(Impairment::kPlainDelay)};
  check(*config);
  return *config;
}

}  // namespace

Impairment::Impairment(const std::optional<ImpairmentConfig>& config, std::uint64_t seed,
                       std::size_t capacity)
    : config_(checked(config)), fate_(seed), timing_(~seed), slots_(capacity), heap_(capacity) {
  for (std::size_t i = 0; i < capacity; ++i) heap_[i].slot = i;
}

bool Impairment::later(const Due& a, const Due& b) noexcept {
  return a.at != b.at ? a.at > b.at : a.order > b.order;
}

void Impairment::push(std::span<const std::byte> datagram, TimePoint now) noexcept {
  ++counters_.pushed;
  const bool is_lost = lost();
  const bool twice = fate_.uniform() < config_.duplicate_ratio;
  const bool held_back = fate_.uniform() < config_.reorder_ratio;
  const bool corrupt = fate_.uniform() < config_.corrupt_ratio;
  const double where = fate_.uniform();
  if (datagram.size() > kMaxDatagramBytes) {
    ++counters_.oversized;
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
  schedule(datagram, now + transit(held_back), bit);
  if (twice && waiting_ < heap_.size()) {
    ++counters_.duplicated;
    schedule(datagram, now + transit(held_back), bit);
  }
}

bool Impairment::lost() noexcept {
  const double random_loss = fate_.uniform(), change = fate_.uniform(), burst = fate_.uniform();
  in_burst_ = in_burst_ ? change >= config_.burst_leave_ratio : change < config_.burst_enter_ratio;
  return random_loss < config_.loss_ratio || (in_burst_ && burst < config_.burst_loss_ratio);
}

double Impairment::jitter() noexcept {
  switch (config_.jitter_kind) {
    case JitterKind::uniform:
      return config_.jitter_ms * (2 * timing_.uniform() - 1);
    case JitterKind::normal:
      return config_.jitter_ms * timing_.normal();
    case JitterKind::gamma:
      break;
  }
  const double u = 1 - timing_.uniform(), v = 1 - timing_.uniform();
  return config_.jitter_ms * -0.5 * std::log(u * v);
}

Duration Impairment::transit(bool held_back) noexcept {
  const double hold_ms = held_back ? config_.reorder_hold_ms : 0;
  return from_seconds(1e-3 * std::max(config_.delay_ms + jitter() + hold_ms, 0.0));
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
