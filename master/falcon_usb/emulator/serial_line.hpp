// One direction of the emulated serial line: bytes in order, each with the time at which its last
// bit is through.
#pragma once

#include <algorithm>
#include <array>
#include <cstddef>

#include "common/time.hpp"

namespace farhand::falcon_usb {

class SerialLine {
 public:
  // The byte follows those before it, not before `from`. What finds no room is lost.
  void push(std::byte b, TimePoint from, Duration byte_time) noexcept {
    free_ = std::max(free_, from) + byte_time;
    if (size_ < ring_.size()) ring_[(first_ + size_++) % ring_.size()] = {free_, b};
  }
  // When the byte `ahead` places behind the first is through; TimePoint::max() if there is none.
  TimePoint time_of(std::size_t ahead) const noexcept {
    return ahead < size_ ? ring_[(first_ + ahead) % ring_.size()].at : TimePoint::max();
  }
  std::byte pop() noexcept {
    const std::byte b = ring_[first_].b;
    first_ = (first_ + 1) % ring_.size();
    --size_;
    return b;
  }
  std::size_t through(TimePoint now) const noexcept {
    std::size_t n = 0;
    while (time_of(n) <= now) ++n;
    return n;
  }
  void clear() noexcept { size_ = 0, free_ = TimePoint::min(); }

 private:
  struct Timed {
    TimePoint at{};
    std::byte b{};
  };
  std::array<Timed, 1024> ring_{};
  std::size_t first_ = 0, size_ = 0;
  TimePoint free_ = TimePoint::min();
};

}  // namespace farhand::falcon_usb
