// A million datagrams that no network should deliver: nothing is accepted that was not sent.
#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <vector>

#include "common/channel.hpp"
#include "common/link.hpp"
#include "tests/support/messages.hpp"

namespace farhand {
namespace {

constexpr std::uint64_t kSeed = 20240607;
constexpr std::size_t kDatagrams = 1000000;
constexpr std::size_t kRecent = 16;

// A datagram in a buffer that may hold more than one.
struct Datagram {
  std::array<std::byte, 2 * kMaxDatagramBytes> bytes{};
  std::size_t size = 0;

  std::span<const std::byte> view() const { return std::span(bytes).first(size); }
  void assign(std::span<const std::byte> from) {
    std::copy(from.begin(), from.end(), bytes.begin());
    size = from.size();
  }
  bool operator==(const Datagram& other) const {
    return std::equal(view().begin(), view().end(), other.view().begin(), other.view().end());
  }
};

class LinkFuzz : public testing::Test {
 protected:
  LinkFuzz() {
    slave.receive(master.hello_due(now), now);
    master.receive(slave.hello_due(now), now);
  }

  std::size_t below(std::size_t n) { return static_cast<std::size_t>(random.bits() % n); }
  const Datagram& any() { return sent[below(kRecent)]; }

  void send_another() {
    now += std::chrono::microseconds(100);
    randomise(random, message);
    Datagram& slot = sent[next++ % kRecent];
    if (next % 64 == 0) {
      now += std::chrono::seconds(1);  // silence, so that a hello is due
      slot.assign(master.hello_due(now));
    } else {
      slot.assign(master.encode(message, now));
    }
    ASSERT_GT(slot.size, 0u);
  }

  void flip_bits(Datagram& d, std::size_t count) {
    for (std::size_t i = 0; i < count; ++i) {
      const std::size_t bit = below(8 * d.size);
      d.bytes[bit / 8] ^= std::byte{1} << static_cast<int>(bit % 8);
    }
  }
  void scribble(Datagram& d, std::size_t from, std::size_t to) {
    for (std::size_t i = from; i < to; ++i) d.bytes[i] = static_cast<std::byte>(random.bits());
  }
  void splice(Datagram& d) {
    const Datagram& tail = any();
    const std::size_t from = below(tail.size), at = below(d.size + 1);
    std::copy(tail.bytes.begin() + static_cast<std::ptrdiff_t>(from),
              tail.bytes.begin() + static_cast<std::ptrdiff_t>(tail.size),
              d.bytes.begin() + static_cast<std::ptrdiff_t>(at));
    d.size = at + tail.size - from;
  }

  void mutate(Datagram& d) {
    d = any();
    switch (below(7)) {
      case 0:
        break;  // as it was: again, late, or for the first time
      case 1:
        d.size = below(d.size);
        break;
      case 2: {
        const std::size_t longer = std::min(d.size + 1 + below(1300), d.bytes.size());
        scribble(d, d.size, longer);
        d.size = longer;
        break;
      }
      case 3:
        splice(d);
        break;
      case 4:
        d.size = below(kMaxDatagramBytes + 100);
        scribble(d, 0, d.size);
        break;
      default:
        flip_bits(d, 1 + below(8));
    }
  }

  Random random{kSeed};
  TimePoint now{std::chrono::hours(1)};
  MasterLink master{{.session = 1, .scene_hash = 3}};
  SlaveLink slave{{.session = 2, .scene_hash = 3}};
  MasterToSlave message;
  std::array<Datagram, kRecent> sent;
  std::size_t next = 0;
};

TEST_F(LinkFuzz, NothingIsAcceptedThatWasNotSent) {
  for (std::size_t i = 0; i < kRecent; ++i) send_another();
  Datagram d;
  for (std::size_t i = 0; i < kDatagrams; ++i) {
    if (i % 4 == 0) send_another();
    mutate(d);
    const Verdict verdict = slave.receive(d.view(), now);
    const bool was_sent = std::find(sent.begin(), sent.end(), d) != sent.end();
    if (verdict == Verdict::accepted) {
      ASSERT_TRUE(was_sent) << "seed " << kSeed << " datagram " << i;
    } else if (was_sent) {
      ASSERT_TRUE(verdict == Verdict::duplicate || verdict == Verdict::older)
          << "seed " << kSeed << " datagram " << i << " " << to_string(verdict);
    }
  }
  const LinkCounters& c = slave.counters();
  EXPECT_EQ(c.received, kDatagrams + 1);
  EXPECT_EQ(c.received, c.accepted() + c.dropped());
  for (const Verdict v :
       {Verdict::accepted, Verdict::too_short, Verdict::too_long, Verdict::bad_magic,
        Verdict::bad_length, Verdict::bad_checksum, Verdict::duplicate, Verdict::older})
    EXPECT_GT(c[v], 1000u) << to_string(v);
}

// The same with a good checksum, as from a peer that is broken or hostile: the link must hold what
// it holds, count, and keep to valid values.
TEST_F(LinkFuzz, BrokenPayloadsInGoodFramesNeitherCrashNorLeaveInvalidValues) {
  for (std::size_t i = 0; i < kRecent; ++i) send_another();
  Datagram d;
  std::array<std::byte, kMaxDatagramBytes> frame;
  for (std::size_t i = 0; i < kDatagrams / 4; ++i) {
    if (i % 4 == 0) send_another();
    mutate(d);
    if (d.size <= kChannelHeaderBytes + kChannelTrailerBytes) continue;
    const auto payload = d.view().subspan(
        kChannelHeaderBytes,
        std::min(d.size - kChannelHeaderBytes - kChannelTrailerBytes, kMaxPayloadBytes));
    slave.receive(std::span(frame).first(seal(payload, frame)), now);
    if (slave.newest() != nullptr) {
      ASSERT_TRUE(valid(slave.newest()->message)) << "seed " << kSeed << " datagram " << i;
    }
    ASSERT_EQ(slave.counters().received, slave.counters().accepted() + slave.counters().dropped());
  }
  EXPECT_GT(slave.counters()[Verdict::malformed], 1000u);
  EXPECT_GT(slave.counters()[Verdict::unexpected_type], 1000u);
}

}  // namespace
}  // namespace farhand
