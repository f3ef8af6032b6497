// Latency histogram of fixed size: 32 buckets per octave from 1 ns, so any quantile is within 2.2 %
// of the true one.
#pragma once

#include <algorithm>
#include <array>
#include <bit>
#include <cstdint>

#include "common/time.hpp"

namespace farhand {

class Histogram {
 public:
  // Negative durations count as zero.
  void add(Duration d) noexcept {
    const auto ns = static_cast<std::uint64_t>(std::max<Duration::rep>(d.count(), 0));
    ++counts_[bucket(ns)];
    ++count_;
    max_ = std::max(max_, ns);
  }

  std::uint64_t count() const noexcept { return count_; }
  Duration max() const noexcept { return Duration(static_cast<Duration::rep>(max_)); }

  // Smallest bucket top that at least the share p in [0, 1] of all samples does not exceed; zero
  // when empty.
  Duration quantile(double p) const noexcept {
    const auto wanted = static_cast<std::uint64_t>(p * static_cast<double>(count_));
    std::uint64_t seen = 0;
    for (std::size_t i = 0; i < counts_.size(); ++i) {
      seen += counts_[i];
      if (seen > 0 && seen >= wanted)
        return Duration(static_cast<Duration::rep>(std::min(top(i), max_)));
    }
    return max();
  }

 private:
  static constexpr int kBits = 5;  // 32 buckets per octave
  static constexpr std::size_t kBuckets = 64u << kBits;

  static std::size_t bucket(std::uint64_t ns) noexcept {
    if (ns < (2u << kBits)) return ns;
    const auto shift = static_cast<std::size_t>(std::bit_width(ns)) - kBits - 1;
    return (shift << kBits) + (ns >> shift);
  }
  static std::uint64_t top(std::size_t i) noexcept {
    if (i < (2u << kBits)) return i;
    const std::size_t shift = (i >> kBits) - 1;
    return (((i - (shift << kBits)) + 1) << shift) - 1;
  }

  std::array<std::uint64_t, kBuckets> counts_{};
  std::uint64_t count_ = 0;
  std::uint64_t max_ = 0;
};

}  // namespace farhand
