// One direction of the network, and what waits in the socket at its end while nobody reads it.
#pragma once

#include <deque>
#include <vector>

#include "common/impairment.hpp"
#include "slave/loop.hpp"

namespace farhand {

// A way whose impairment may change; what is under way still arrives as it would have.
class NetworkWay {
 public:
  NetworkWay(const std::optional<ImpairmentConfig>& config, std::uint64_t seed)
      : seed_(seed), present_(config, seed) {}

  void change(const std::optional<ImpairmentConfig>& config) {
    std::erase_if(former_, [](const Impairment& i) { return i.waiting() == 0; });
    if (present_.waiting() > 0) former_.push_back(std::move(present_));
    seed_ += 0x9e3779b97f4a7c15;
    present_ = Impairment(config, seed_);
  }
  void push(std::span<const std::byte> datagram, TimePoint now) noexcept {
    present_.push(datagram, now);
  }
  std::optional<TimePoint> next_due() const noexcept { return next().next_due(); }
  std::span<const std::byte> pop(TimePoint now, std::span<std::byte> out) noexcept {
    return const_cast<Impairment&>(next()).pop(now, out);
  }

 private:
  const Impairment& next() const noexcept {
    const Impairment* first = &present_;
    for (const Impairment& i : former_)
      if (i.next_due() && (!first->next_due() || *i.next_due() < *first->next_due())) first = &i;
    return *first;
  }

  std::uint64_t seed_;
  Impairment present_;
  std::vector<Impairment> former_;
};

// As a socket's receive buffer of the usual 208 kB, in which a small datagram takes 768 bytes.
class SocketQueue {
 public:
  static constexpr std::size_t kMost = 277;

  bool empty() const noexcept { return waiting_.empty(); }
  void clear() noexcept { waiting_.clear(); }
  void push(std::span<const std::byte> d) {
    if (waiting_.size() < kMost) waiting_.emplace_back(d.begin(), d.end());
  }
  // What a turn of either loop takes at once.
  template <typename Receive>
  void take_burst(Receive&& receive) {
    for (int i = 0; i < SlaveLoop::kBurst && !waiting_.empty(); ++i) {
      receive(std::span<const std::byte>(waiting_.front()));
      waiting_.pop_front();
    }
  }

 private:
  std::deque<std::vector<std::byte>> waiting_;
};

}  // namespace farhand
