// The least of what came in the last while, to an eighth of it.
#pragma once

#include <algorithm>
#include <array>
#include <cstdint>

#include "common/time.hpp"

namespace farhand {

class RecentMinimum {
 public:
  explicit RecentMinimum(Duration window) noexcept : grain_(window / kGrains) {
    least_.fill(Duration::max());
  }

  // Times must not run backwards.
  void add(Duration at, Duration value) noexcept {
    const std::int64_t grain = at / grain_;
    for (std::int64_t g = std::max(newest_ + 1, grain - kGrains); !empty_ && g <= grain; ++g)
      least_[static_cast<std::size_t>(g % kGrains)] = Duration::max();
    newest_ = empty_ ? grain : std::max(newest_, grain);
    empty_ = false;
    Duration& least = least_[static_cast<std::size_t>(newest_ % kGrains)];
    least = std::min(least, value);
    minimum_ = *std::min_element(least_.begin(), least_.end());
  }
  bool empty() const noexcept { return empty_; }
  Duration minimum() const noexcept { return minimum_; }

 private:
  static constexpr std::int64_t kGrains = 8;
  Duration grain_;
  std::array<Duration, kGrains> least_;
  std::int64_t newest_ = 0;
  bool empty_ = true;
  Duration minimum_{};
};

}  // namespace farhand
