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

// Number and way of each that arrives first.
std::vector<std::optional<Duration>> ways(const ImpairmentConfig& config, std::uint64_t count) {
  Impairment network(config, 14);
  std::vector<std::optional<Duration>> out(count);
  for (const Out& o : run(network, count))
    if (!out[o.number]) out[o.number] = o.at - pushed_at(o.number);
  return out;
}

TEST(Impairment, AChangeOfOneLeavesTheJitterOfAllOthersAlone) {
  const ImpairmentConfig plain{.delay_ms = 50, .jitter_ms = 5};
  const auto before = ways(plain, 3000);
  ImpairmentConfig lossy = plain, capped = plain, dark = plain, spiky = plain;
  lossy.loss_ratio = 0.1, lossy.burst_enter_ratio = 0.01, lossy.burst_leave_ratio = 0.2;
  capped.cap_kbit_per_s = 1e5;  // enough for all
  dark.blackouts[0] = {.at_s = 1, .length_s = 0.2};
  spiky.spike_ms = 1e-6;
  for (const ImpairmentConfig& c : {lossy, capped, dark, spiky}) {
    const auto after = ways(c, 3000);
    std::size_t arrived = 0;
    for (std::size_t i = 0; i < after.size(); ++i) {
      ASSERT_LE(after[i].value_or(*before[i]) - *before[i], 1ns) << i;
      ASSERT_GE(after[i].value_or(*before[i]), *before[i]) << i;
      arrived += after[i].has_value();
    }
    EXPECT_GT(arrived, 2000u);
  }
  ImpairmentConfig doubled = plain;
  doubled.duplicate_ratio = 0.5;
  const auto after = ways(doubled, 3000);  // the copy may come first, never later
  for (std::size_t i = 0; i < after.size(); ++i) ASSERT_LE(*after[i], *before[i]) << i;
}

TEST(Impairment, BlackoutsLoseEverythingInTheirWindows) {
  ImpairmentConfig c{.delay_ms = 10};
  c.blackouts[0] = {.at_s = 1, .length_s = 0.2};
  c.blackouts[1] = {.at_s = 3, .length_s = 0.1, .period_s = 1};
  const auto out = ways(c, 6000);
  for (std::size_t i = 0; i < out.size(); ++i) {
    const bool dark = (i >= 1000 && i < 1200) || (i >= 3000 && i % 1000 < 100);
    ASSERT_EQ(out[i].has_value(), !dark) << i;
  }
}

TEST(Impairment, AStepAndADriftChangeTheWay) {
  const auto stepped =
      ways({.delay_ms = 50, .step_ms = 150, .step_at_s = 1, .step_length_s = 2}, 4000);
  for (std::size_t i = 0; i < stepped.size(); ++i)
    ASSERT_EQ(*stepped[i], i >= 1000 && i < 3000 ? 200ms : 50ms) << i;
  const auto drifted = ways({.delay_ms = 50, .delay_drift_ms_per_s = 2}, 4000);
  EXPECT_EQ(*drifted[0], 50ms);
  EXPECT_NEAR(seconds(*drifted[3000]), 56e-3, 1e-9);
}

// Pauses are exponential: n of them of mean 1 s, n spikes of 50 ms.
TEST(Impairment, SpikesStopTheNetworkForTheirLength) {
  constexpr std::uint64_t kCount = 2'000'000;
  const auto out = ways({.spike_ms = 50, .spike_pause_s = 1}, kCount);
  std::uint64_t stalled = 0, spikes = 0;
  for (std::size_t i = 0; i < kCount; ++i) {
    ASSERT_LE(*out[i], 50ms);
    stalled += *out[i] > 0ns;
    spikes += *out[i] > 0ns && *out[i - 1] == 0ns;
    if (i > 0 && *out[i - 1] > 1ms) {  // all at its end
      ASSERT_EQ(*out[i - 1] - *out[i], 1ms);
    }
  }
  const double n = kCount * 1e-3 / 1.05;
  EXPECT_NEAR(static_cast<double>(spikes), n, 5 * std::sqrt(n) + 0.06 * n);  // some join
  EXPECT_NEAR(static_cast<double>(stalled), 50 * n, 50 * 5 * std::sqrt(n));
}

// 200 bytes at 1 kHz are 1600 kbit/s.
TEST(Impairment, ARateCapPassesItsRateAndQueuesNoMoreThanStated) {
  constexpr std::uint64_t kCount = 20000;
  const ImpairmentConfig c{.cap_kbit_per_s = 200, .cap_burst_bytes = 1000, .cap_queue_bytes = 5000};
  Impairment network(c, 15);
  Duration longest{};
  const auto out = run(network, kCount);
  for (const Out& o : out) longest = std::max(longest, o.at - pushed_at(o.number));
  EXPECT_LE(longest, 200ms);  // 5000 bytes at 25 bytes per ms
  EXPECT_GT(longest, 192ms);  // less than one datagram short of it
  // Bucket and queue beyond what 20 s let through, to a datagram.
  EXPECT_NEAR(static_cast<double>(out.size()), (20 * 25000 + 1000 + 5000) / 200.0, 1);
  EXPECT_EQ(network.counters().capped + out.size(), kCount);
  for (std::size_t i = 0; i < 5; ++i) EXPECT_EQ(out[i].at, pushed_at(i));  // the bucket's
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
  EXPECT_NE(refusal({.spike_ms = 5, .spike_pause_s = 0}).find("spike_pause_s"), std::string::npos);
  EXPECT_NE(refusal({.cap_kbit_per_s = -1}).find("cap_kbit_per_s"), std::string::npos);
  EXPECT_EQ(refusal({.loss_ratio = 1}), "");
}

}  // namespace
}  // namespace farhand
