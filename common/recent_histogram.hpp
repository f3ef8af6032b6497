// Counts of the last stretch of time by bins, in eighths of it. Bounded work, no allocation.
#pragma once

#include <algorithm>
#include <array>
#include <cstddef>
#include <cstdint>

#include "common/time.hpp"

namespace farhand {

class RecentHistogram {
 public:
  static constexpr std::size_t kBins = 256;  // what is beyond counts in the last

  // window > 0
  explicit RecentHistogram(Duration window) noexcept : grain_(window / kGrains) {}

  // Times before one seen already count as that.
  void add(Duration at, std::size_t bin) noexcept {
    const std::int64_t grain = std::max(at / grain_, newest_);
    for (std::int64_t g = std::max(newest_ + 1, grain - kGrains + 1); g <= grain; ++g) clear(of(g));
    newest_ = grain;
    bin = std::min(bin, kBins - 1);
    ++of(grain)[bin];
    ++all_[bin];
    ++total_;
  }
  bool empty() const noexcept { return total_ == 0; }

  // The least number of bins that all but a share of the counts lie in; 1 without counts.
  std::size_t most(double share) const noexcept {
    double above = 0;
    std::size_t bins = kBins;
    while (bins > 1 && above + all_[bins - 1] <= share * total_) above += all_[--bins];
    return bins;
  }

  // All counts move down by so many bins; the lowest gathers them.
  void lower(std::size_t bins) noexcept {
    for (Counts& grain : grains_) lower(grain, std::min(bins, kBins - 1));
    lower(all_, std::min(bins, kBins - 1));
  }

 private:
  using Counts = std::array<std::uint32_t, kBins>;
  static constexpr std::int64_t kGrains = 8;

  Counts& of(std::int64_t grain) noexcept {
    return grains_[static_cast<std::size_t>(grain % kGrains)];
  }
  void clear(Counts& grain) noexcept {
    for (std::size_t i = 0; i < kBins; ++i) all_[i] -= grain[i], total_ -= grain[i];
    grain.fill(0);
  }
  static void lower(Counts& counts, std::size_t bins) noexcept {
    for (std::size_t i = 1; i <= bins; ++i) counts[0] += counts[i];
    const auto by = static_cast<std::ptrdiff_t>(bins);
    std::shift_left(counts.begin() + 1, counts.end(), by);
    std::fill(counts.end() - by, counts.end(), 0);
  }

  Duration grain_;
  std::int64_t newest_ = 0;
  std::array<Counts, kGrains> grains_{};
  Counts all_{};
  std::uint32_t total_ = 0;
};

}  // namespace farhand
