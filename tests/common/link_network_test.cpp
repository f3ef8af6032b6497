// Both ends of the link over bad networks (common/link.hpp).
#include "common/impairment.hpp"
#include "tests/support/link_ends.hpp"

namespace farhand {
namespace {

using namespace std::chrono_literals;

// In virtual time.
struct World {
  explicit World(const ImpairmentConfig& config, std::uint64_t seed)
      : down(config, seed), up(config, seed + 1) {}

  template <typename To>
  void deliver(Impairment& network, To& to) {
    std::array<std::byte, kMaxDatagramBytes> buffer;
    while (network.next_due() && *network.next_due() <= now) {
      to.receive(network.pop(now, buffer), now);
      if (!to.answer().empty()) up.push(to.answer(), now);  // a slave's
    }
  }
  template <typename From>
  void offer(From& from, Impairment& network) {
    for (const auto bytes : {from.hello_due(now), from.encode({}, now)})
      if (!bytes.empty()) network.push(bytes, now);
  }
  void run(MasterLink& master, SlaveLink& slave, Duration time) {
    for (const TimePoint end = now + time; now < end; now += 1ms) {
      deliver(up, master);
      deliver(down, slave);
      offer(master, down);
      offer(slave, up);
    }
  }

  TimePoint now = kStart;
  Impairment down, up;
};

constexpr ImpairmentConfig kBad{.delay_ms = 25,
                                .jitter_ms = 3,
                                .loss_ratio = 0.1,
                                .duplicate_ratio = 0.05,
                                .reorder_ratio = 0.02,
                                .corrupt_ratio = 0.02};

TEST(LinkOverABadNetwork, ARestartOfEitherSideReconnects) {
  for (std::uint64_t seed = 1; seed <= 10; ++seed) {
    World world(kBad, seed);
    std::optional<MasterLink> master;
    std::optional<SlaveLink> slave;
    master.emplace(LinkConfig{.session = 1, .scene_hash = kScene});
    slave.emplace(LinkConfig{.session = 2, .scene_hash = kScene});
    world.run(*master, *slave, 2s);
    const auto well = [&] {
      return master->fresh(world.now, 60ms) && slave->fresh(world.now, 60ms);
    };
    ASSERT_TRUE(well()) << "seed " << seed;
    for (std::uint64_t restart = 0; restart < 12; ++restart) {
      const LinkConfig config{.session = 100 + restart, .scene_hash = kScene};
      if (restart % 3 != 1) master.emplace(config);  // alone, or both at once
      if (restart % 3 != 0) slave.emplace(LinkConfig{200 + restart, kScene});
      world.run(*master, *slave, 1500ms);  // the old master's lease is 500 ms of it
      ASSERT_TRUE(well()) << "seed " << seed << " restart " << restart;
    }
  }
}

TEST(LinkOverABadNetwork, LossesAndReorderingAreTheNetworks) {
  for (std::uint64_t seed = 1; seed <= 3; ++seed) {
    World world(kBad, seed);
    MasterLink master({.session = 1, .scene_hash = kScene});
    SlaveLink slave({.session = 2, .scene_hash = kScene});
    world.run(master, slave, 60s);
    const LinkCounters& c = slave.counters();
    EXPECT_EQ(c.received, world.down.counters().popped);
    EXPECT_EQ(c.received, c.accepted() + c.dropped()) << "seed " << seed;
    const ImpairmentCounters& network = world.down.counters();
    const double gone = static_cast<double>(network.lost + network.corrupted);
    EXPECT_NEAR(static_cast<double>(slave.quality().lost), gone, 100) << "seed " << seed;
    EXPECT_EQ(slave.quality().reordered, c[Verdict::older]);
    EXPECT_GT(c[Verdict::older], 1000u);
    EXPECT_GT(c[Verdict::duplicate], 1000u);
    EXPECT_NEAR(seconds(slave.clock().offset), 0, 1.5e-3) << "seed " << seed;
    EXPECT_GE(slave.clock().round_trip, 50ms);
  }
}

// The networks of a bench for compensation methods: round trips to 400 ms with any jitter, a step
// of the round trip from 50 to 200 ms, loss. None is too late but what waits in the queue of a line
// that is too thin.
TEST(LinkOverABadNetwork, NothingIsTooLateButBehindAThinLine) {
  const auto too_late = [](const ImpairmentConfig& config) {
    World world(config, 1);
    MasterLink master({.session = 1, .scene_hash = kScene});
    SlaveLink slave({.session = 2, .scene_hash = kScene});
    world.run(master, slave, 5s);
    return slave.counters()[Verdict::too_late] + master.counters()[Verdict::too_late];
  };
  for (const double way : {0., 2.5, 5., 10., 25., 50., 100., 200.})
    for (const double loss : {0., 0.1}) {
      ImpairmentConfig c{.delay_ms = way, .loss_ratio = loss};
      EXPECT_EQ(too_late(c), 0u) << way;
      c.jitter_ms = way / 10;
      EXPECT_EQ(too_late(c), 0u) << way;
      c.spike_ms = 50;
      EXPECT_EQ(too_late(c), 0u) << way;
      c.delay_drift_ms_per_s = way / 600;
      EXPECT_EQ(too_late(c), 0u) << way;
    }
  EXPECT_EQ(too_late({.delay_ms = 25, .step_ms = 75, .step_at_s = 1, .step_length_s = 2}), 0u);
  EXPECT_GT(too_late({.delay_ms = 25, .spike_ms = 150}), 0u);
  EXPECT_GT(too_late({.delay_ms = 25, .cap_kbit_per_s = 200}), 0u);
}

TEST(LinkOverABadNetwork, ABlackoutEndsByItself) {
  World world({.delay_ms = 10}, 1);
  MasterLink master({.session = 1, .scene_hash = kScene});
  SlaveLink slave({.session = 2, .scene_hash = kScene});
  world.run(master, slave, 1s);
  world.now += 5s;  // what was under way arrives too late, nothing was sent meanwhile
  world.run(master, slave, 100ms);
  EXPECT_TRUE(master.fresh(world.now, 2ms) && slave.fresh(world.now, 2ms));
  EXPECT_EQ(slave.quality().lost, 10u);  // those of 10 ms
  EXPECT_EQ(slave.counters()[Verdict::too_late], 10u);
  EXPECT_EQ(slave.clock().offset, 0s);
}

}  // namespace
}  // namespace farhand
