// A master's and a slave's end of a link with nothing between them but a test.
#pragma once

#include <gtest/gtest.h>

#include <array>
#include <functional>
#include <span>
#include <vector>

#include "common/channel.hpp"
#include "common/link.hpp"

namespace farhand {

using Bytes = std::vector<std::byte>;

inline constexpr std::uint64_t kScene = 0x5ce4e;
inline constexpr TimePoint kStart{std::chrono::hours(1)};

inline Bytes copy(std::span<const std::byte> bytes) {
  return {bytes.begin(), bytes.end()};
}

inline MasterToSlave numbered(std::uint32_t n) {
  MasterToSlave m;
  m.clutch_presses = n;
  return m;
}

class LinkTest : public testing::Test {
 protected:
  // Both hellos across, and one message each way.
  void connect() {
    slave.receive(copy(master.hello_due(now)), now);
    master.receive(copy(slave.hello_due(now)), now);
    slave.receive(copy(master.encode(numbered(0), now)), now);
    master.receive(copy(slave.encode({}, now)), now);
    ASSERT_TRUE(master.connected() && slave.connected());
  }
  Bytes next(std::uint32_t n = 0) { return copy(master.encode(numbered(n), now)); }

  // A datagram from the master's session, with the header changed by f.
  Bytes forged(const std::function<void(Header&)>& f, const MasterToSlave& m = {}) {
    Header h{.session = 1, .peer_session = 2, .sequence = 1000, .sent = 1};
    f(h);
    std::array<std::byte, kMaxPayloadBytes> payload;
    Bytes out(kMaxDatagramBytes);
    out.resize(seal(std::span(payload).first(codec.encode(h, m, payload)), out));
    return out;
  }
  Bytes hello(const Hello& h) {
    std::array<std::byte, kMaxPayloadBytes> payload;
    Bytes out(kMaxDatagramBytes);
    out.resize(seal(std::span(payload).first(codec.encode(h, payload)), out));
    return out;
  }
  void expect_dropped(const Bytes& datagram, Verdict reason) {
    const LinkCounters before = slave.counters();
    const std::uint64_t newest = slave.newest() != nullptr ? slave.newest()->sequence : 0;
    EXPECT_EQ(slave.receive(datagram, now), reason) << to_string(reason);
    EXPECT_EQ(slave.counters()[reason], before[reason] + 1) << to_string(reason);
    EXPECT_EQ(slave.counters().dropped(), before.dropped() + 1) << to_string(reason);
    EXPECT_EQ(slave.counters().accepted(), before.accepted());
    EXPECT_EQ(slave.newest() != nullptr ? slave.newest()->sequence : 0, newest);
    EXPECT_EQ(slave.counters().received, slave.counters().accepted() + slave.counters().dropped());
  }

  TimePoint now = kStart;
  MasterLink master{{.session = 1, .scene_hash = kScene}};
  SlaveLink slave{{.session = 2, .scene_hash = kScene}};
  Codec codec;
};

}  // namespace farhand
