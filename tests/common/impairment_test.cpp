#include "common/impairment.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <bit>
#include <cmath>
#include <stdexcept>
#include <vector>

#include "common/bytes.hpp"
#include "tests/support/allocations.hpp"

namespace farhand {
namespace {

using namespace std::chrono_literals;

struct Out {
  std::uint64_t number;
  TimePoint at;
  std::vector<std::byte> bytes;
};

TimePoint pushed_at(std::uint64_t number) {
  return TimePoint(1ms * static_cast<std::int64_t>(number));
}

std::vector<std::byte> datagram(std::uint64_t number, std::size_t size = 200) {
  std::vector<std::byte> out(size, std::byte{0x55});
  store_little_endian(number, out.data());
  return out;
}

void drain(Impairment& network, TimePoint until, std::vector<Out>& out) {
  std::array<std::byte, kMaxDatagramBytes> buffer;
  while (network.next_due() && *network.next_due() <= until) {
    const TimePoint at = *network.next_due();
    const auto bytes = network.pop(at, buffer);
    out.push_back({load_little_endian<std::uint64_t>(bytes.data()), at,
                   std::vector(bytes.begin(), bytes.end())});
  }
}

// `count` datagrams at 1 kHz, and all that comes out.
std::vector<Out> run(Impairment& network, std::uint64_t count) {
  std::vector<Out> out;
  for (std::uint64_t i = 0; i < count; ++i) {
    drain(network, pushed_at(i), out);
    network.push(datagram(i), pushed_at(i));
  }
  drain(network, TimePoint::max(), out);
  return out;
}

double share(std::uint64_t part, std::uint64_t whole) {
  return static_cast<double>(part) / static_cast<double>(whole);
}
// Five standard deviations of a share p among n.
double slack(double p, double n) {
  return 5 * std::sqrt(p * (1 - p) / n);
}

TEST(Impairment, WithoutAConfigurationAllPassInOrderAfterAFixedDelay) {
  Impairment network({}, 1);
  const auto out = run(network, 1000);
  ASSERT_EQ(out.size(), 1000u);
  for (std::uint64_t i = 0; i < 1000; ++i) {
    EXPECT_EQ(out[i].number, i);
    EXPECT_EQ(out[i].at, pushed_at(i) + Impairment::kPlainDelay);
    EXPECT_EQ(out[i].bytes, datagram(i));
  }
}

TEST(Impairment, NothingComesOutBeforeItsTime) {
  Impairment network(ImpairmentConfig{.delay_ms = 25}, 1);
  std::array<std::byte, kMaxDatagramBytes> buffer;
  EXPECT_FALSE(network.next_due().has_value());
  EXPECT_TRUE(network.pop(TimePoint::max(), buffer).empty());
  network.push(datagram(7), TimePoint(10ms));
  EXPECT_EQ(network.next_due(), TimePoint(35ms));
  EXPECT_TRUE(network.pop(TimePoint(35ms - 1ns), buffer).empty());
  EXPECT_EQ(network.pop(TimePoint(35ms), buffer).size(), 200u);
  EXPECT_EQ(network.waiting(), 0u);
}

TEST(Impairment, SameSeedSameBitsAndAnotherSeedOthers) {
  const ImpairmentConfig all{.delay_ms = 20,
                             .jitter_ms = 3,
                             .loss_ratio = 0.02,
                             .burst_enter_ratio = 0.002,
                             .burst_leave_ratio = 0.2,
                             .duplicate_ratio = 0.05,
                             .reorder_ratio = 0.05,
                             .corrupt_ratio = 0.05};
  const auto outcome = [&](std::uint64_t seed) {
    Impairment network(all, seed);
    std::vector<std::byte> bytes;
    for (const Out& o : run(network, 5000)) {
      bytes.insert(bytes.end(), o.bytes.begin(), o.bytes.end());
      std::array<std::byte, 8> at;
      store_little_endian(static_cast<std::uint64_t>(o.at.time_since_epoch().count()), at.data());
      bytes.insert(bytes.end(), at.begin(), at.end());
    }
    return bytes;
  };
  const auto first = outcome(9);
  EXPECT_EQ(first, outcome(9));
  EXPECT_NE(first, outcome(10));
}

TEST(Impairment, TheDelayDoesNotDecideWhichAreLost) {
  const auto survivors = [](const ImpairmentConfig& config) {
    Impairment network(config, 3);
    std::vector<std::uint64_t> numbers;
    for (const Out& o : run(network, 5000)) numbers.push_back(o.number);
    std::sort(numbers.begin(), numbers.end());
    return numbers;
  };
  EXPECT_EQ(survivors({.loss_ratio = 0.1}),
            survivors({.delay_ms = 50, .jitter_ms = 10, .loss_ratio = 0.1, .reorder_ratio = 0.2}));
}

TEST(Impairment, RandomLossesComeAtTheirRatioAndAlone) {
  constexpr std::uint64_t kCount = 200000;
  Impairment network(ImpairmentConfig{.loss_ratio = 0.05}, 4);
  const auto out = run(network, kCount);
  EXPECT_NEAR(share(network.counters().lost, kCount), 0.05, slack(0.05, kCount));
  EXPECT_EQ(out.size() + network.counters().lost, kCount);
  std::uint64_t bursts = 0;
  for (std::size_t i = 1; i < out.size(); ++i) bursts += out[i].number != out[i - 1].number + 1;
  EXPECT_NEAR(share(network.counters().lost, bursts), 1 / 0.95, 0.02);
}

TEST(Impairment, BurstLossesHaveTheirShareAndMeanLength) {  // about 1 % in bursts of 5
  constexpr std::uint64_t kCount = 500000;
  constexpr double kEnter = 0.002, kLeave = 0.2;
  Impairment network(ImpairmentConfig{.burst_enter_ratio = kEnter, .burst_leave_ratio = kLeave}, 5);
  const auto out = run(network, kCount);
  std::uint64_t bursts = 0;
  for (std::size_t i = 1; i < out.size(); ++i) bursts += out[i].number != out[i - 1].number + 1;
  EXPECT_NEAR(share(network.counters().lost, kCount), kEnter / (kEnter + kLeave), 0.0012);
  EXPECT_NEAR(share(network.counters().lost, bursts), 1 / kLeave, 0.8);
}

TEST(Impairment, EveryJitterHasItsMeanAndSpread) {
  constexpr std::uint64_t kCount = 100000;
  struct Case {
    JitterKind kind;
    double mean, deviation;  // [ms]
  };
  for (const Case& c :
       {Case{JitterKind::uniform, 40, 4 / std::sqrt(3.0)}, Case{JitterKind::normal, 40, 4},
        Case{JitterKind::gamma, 44, 4 / std::sqrt(2.0)}}) {
    Impairment network(ImpairmentConfig{.delay_ms = 40, .jitter_ms = 4, .jitter_kind = c.kind}, 6);
    double sum = 0, squares = 0;
    for (const Out& o : run(network, kCount)) {
      const double ms = 1e3 * seconds(o.at - pushed_at(o.number));
      sum += ms;
      squares += (ms - c.mean) * (ms - c.mean);
    }
    EXPECT_NEAR(sum / kCount, c.mean, 5 * c.deviation / std::sqrt(kCount));
    EXPECT_NEAR(std::sqrt(squares / kCount), c.deviation, 0.02 * c.deviation);
  }
}

TEST(Impairment, JitterReordersUnlessTheOrderIsKept) {
  const auto swaps = [](bool keep_order) {
    Impairment network(ImpairmentConfig{.delay_ms = 20, .jitter_ms = 5, .keep_order = keep_order},
                       7);
    const auto out = run(network, 10000);
    EXPECT_EQ(out.size(), 10000u);
    std::size_t n = 0;
    for (std::size_t i = 1; i < out.size(); ++i) n += out[i].number < out[i - 1].number;
    return n;
  };
  EXPECT_GT(swaps(false), 1000u);
  EXPECT_EQ(swaps(true), 0u);
}

TEST(Impairment, HeldBackOnesAreOvertaken) {
  constexpr std::uint64_t kCount = 50000;
  Impairment network(ImpairmentConfig{.delay_ms = 10, .reorder_ratio = 0.1, .reorder_hold_ms = 2.5},
                     8);
  std::uint64_t late = 0;
  for (const Out& o : run(network, kCount)) {
    const Duration way = o.at - pushed_at(o.number);
    EXPECT_TRUE(way == 10ms || way == 12500us);
    late += way > 10ms;
  }
  EXPECT_EQ(late, network.counters().held_back);
  EXPECT_NEAR(share(late, kCount), 0.1, slack(0.1, kCount));
}

TEST(Impairment, DuplicatesComeTwice) {
  constexpr std::uint64_t kCount = 50000;
  Impairment network(ImpairmentConfig{.delay_ms = 10, .jitter_ms = 1, .duplicate_ratio = 0.1}, 9);
  std::vector<int> times(kCount);
  for (const Out& o : run(network, kCount)) ++times[o.number];
  EXPECT_EQ(*std::min_element(times.begin(), times.end()), 1);
  EXPECT_EQ(*std::max_element(times.begin(), times.end()), 2);
  const auto twice = static_cast<std::uint64_t>(std::count(times.begin(), times.end(), 2));
  EXPECT_EQ(twice, network.counters().duplicated);
  EXPECT_NEAR(share(twice, kCount), 0.1, slack(0.1, kCount));
}

TEST(Impairment, CorruptionFlipsOneBitAnywhere) {
  constexpr std::uint64_t kCount = 50000;
  constexpr std::size_t kBits = 200 * 8;
  Impairment network(ImpairmentConfig{.corrupt_ratio = 0.2}, 10);
  std::vector<int> hit(kBits);
  std::uint64_t corrupted = 0, i = 0;
  for (const Out& o : run(network, kCount)) {
    const auto sent = datagram(i++);
    int flips = 0;
    for (std::size_t k = 0; k < sent.size(); ++k) {
      const auto difference = static_cast<std::uint8_t>(sent[k] ^ o.bytes[k]);
      flips += std::popcount(difference);
      if (difference != 0) ++hit[8 * k + static_cast<std::size_t>(std::countr_zero(difference))];
    }
    ASSERT_LE(flips, 1);
    corrupted += flips > 0;
  }
  EXPECT_EQ(corrupted, network.counters().corrupted);
  EXPECT_NEAR(share(corrupted, kCount), 0.2, slack(0.2, kCount));
  EXPECT_LT(std::count(hit.begin(), hit.end(), 0),
            20);  // 6 hits each on average: e^-6 of 1600 none
}

TEST(Impairment, WhatDoesNotFitIsCounted) {
  Impairment network(ImpairmentConfig{.delay_ms = 10, .duplicate_ratio = 0.5}, 11, 8);
  for (std::uint64_t i = 0; i < 20; ++i) network.push(datagram(i), TimePoint(0ms));
  network.push(std::vector<std::byte>(kMaxDatagramBytes + 1), TimePoint(0ms));
  network.push(std::vector<std::byte>(kMaxDatagramBytes), TimePoint(0ms));
  EXPECT_EQ(network.waiting(), 8u);
  EXPECT_EQ(network.counters().oversized, 1u);
  std::vector<Out> out;
  drain(network, TimePoint(10ms), out);
  EXPECT_EQ(out.size(), 8u);
  const ImpairmentCounters& c = network.counters();
  EXPECT_EQ(c.popped, 8u);
  EXPECT_EQ(c.pushed, c.lost + c.overflowed + c.oversized + c.popped - c.duplicated);
  network.push(datagram(99), TimePoint(20ms));
  EXPECT_GE(network.waiting(), 1u);
}

TEST(Impairment, TheCountersAddUp) {
  Impairment network(ImpairmentConfig{.delay_ms = 5,
                                      .jitter_ms = 5,
                                      .loss_ratio = 0.1,
                                      .burst_enter_ratio = 0.01,
                                      .burst_leave_ratio = 0.1,
                                      .duplicate_ratio = 0.3},
                     12, 16);
  for (std::uint64_t i = 0; i < 10000; ++i) {
    network.push(datagram(i), pushed_at(i));
    std::vector<Out> out;
    drain(network, pushed_at(i), out);
    const ImpairmentCounters& c = network.counters();
    ASSERT_EQ(c.pushed + c.duplicated,
              c.lost + c.overflowed + c.oversized + c.popped + network.waiting());
  }
  EXPECT_GT(network.counters().overflowed, 0u);
}

TEST(Impairment, TakesNothingFromTheHeapOnceBuilt) {
  Impairment network(
      ImpairmentConfig{.delay_ms = 5, .jitter_ms = 5, .duplicate_ratio = 0.3, .corrupt_ratio = 0.1},
      13);
  const auto bytes = datagram(1);
  std::array<std::byte, kMaxDatagramBytes> buffer;
  EXPECT_EQ(allocations_in([&] {
              for (std::uint64_t i = 0; i < 3000; ++i) {
                network.push(bytes, pushed_at(i));
                while (!network.pop(pushed_at(i), buffer).empty()) {
                }
              }
            }),
            0u);
  EXPECT_GT(network.counters().popped, 3000u);
}

TEST(Impairment, AnImpossibleConfigurationIsRefusedByName) {
  const auto refusal = [](const ImpairmentConfig& config) -> std::string {
    try {
      Impairment network(config, 1);
    } catch (const std::invalid_argument& e) {
      return e.what();
    }
    return "";
  };
  EXPECT_NE(refusal({.loss_ratio = 1.5}).find("loss_ratio"), std::string::npos);
  EXPECT_NE(refusal({.corrupt_ratio = -0.1}).find("corrupt_ratio"), std::string::npos);
  EXPECT_NE(refusal({.delay_ms = NAN}).find("delay_ms"), std::string::npos);
  EXPECT_NE(refusal({.reorder_hold_ms = -1}).find("reorder_hold_ms"), std::string::npos);
  EXPECT_EQ(refusal({.loss_ratio = 1}), "");
}

}  // namespace
}  // namespace farhand
