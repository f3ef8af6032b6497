// The newest value from one thread to another, wait-free on both sides: three places, of which
// writer and reader hold one each and swap theirs for the third. Values in between are lost.
#pragma once

#include <array>
#include <atomic>
#include <cstdint>

namespace farhand {

template <typename T>
class Newest {
 public:
  // Writer.
  void put(const T& value) noexcept {
    places_[mine_] = value;
    mine_ = shared_.exchange(mine_ | kNew, std::memory_order_acq_rel) & kPlace;
  }

  // Reader. The newest value if there is one that was not taken yet, otherwise nullptr. Valid until
  // the next call.
  const T* take() noexcept {
    if ((shared_.load(std::memory_order_relaxed) & kNew) == 0) return nullptr;
    theirs_ = shared_.exchange(theirs_, std::memory_order_acq_rel) & kPlace;
    return &places_[theirs_];
  }

 private:
  static constexpr std::uint8_t kPlace = 3, kNew = 4;

  std::array<T, 3> places_{};
  std::uint8_t mine_ = 0;  // the writer's place
  std::atomic<std::uint8_t> shared_{1};
  std::uint8_t theirs_ = 2;  // the reader's
};

}  // namespace farhand
