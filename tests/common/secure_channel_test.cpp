// Both ends with their two halves: connecting, restarting, and what the loop's half may cost.
#include "common/secure_channel.hpp"

#include <gtest/gtest.h>

#include <thread>

#include "tests/support/allocations.hpp"
#include "tests/support/both_proofs.hpp"
#include "tests/support/dtls_ends.hpp"

namespace farhand {
namespace {

using std::chrono::milliseconds;
using std::chrono::seconds;

const UdpAddress kSecondAddress = test_address(5);

// One end, as a loop of 1 kHz with a service every 5 ms would drive it; each turn sends a record.
struct End {
  End(bool client, const SideCredentials& sides)
      : channel({.server = client ? std::optional(kServerAddress) : std::nullopt},
                client ? sides.client : sides.server) {}

  void receive(std::span<const std::byte> datagram, const UdpAddress& from) {
    if (channel.take(datagram, from)) return;
    const Opened got = channel.open(datagram, payload);
    if (got.verdict == Verdict::accepted && takes_all) channel.settle();
    ++(got.verdict == Verdict::accepted ? accepted : refused);
    ++verdicts[static_cast<std::size_t>(got.verdict)];
  }

  SecureChannel channel;
  Bytes payload = Bytes(kMaxPayloadBytes);
  bool takes_all = true;  // as a link that accepts whatever is opened
  std::uint64_t accepted = 0, refused = 0;
  std::array<std::uint64_t, kVerdicts> verdicts{};
};

class SecureChannelTest : public testing::TestWithParam<Proof> {
 protected:
  SecureChannelTest() { restart(client, true), restart(server, false); }

  void restart(std::unique_ptr<End>& end, bool is_client) {
    end = std::make_unique<End>(is_client, ours);
  }
  void send(End& from, End& to, const UdpAddress& from_address) {
    if (&from == mute || &to == mute) return;
    while (const DtlsOutgoing* out = from.channel.outgoing()) {
      End& there = second && out->to == kSecondAddress ? *second : to;
      if (!lost()) there.receive(out->datagram(), from_address);
    }
    Bytes record(kMaxDatagramBytes);
    record.resize(from.channel.seal(payload, record));
    if (record.empty()) return;
    last = record;
    if (!lost()) to.receive(record, from_address);
  }
  bool lost() { return loss > 0 && random.uniform() < loss; }
  void run(Duration length) {
    for (const TimePoint end = now + length; now < end;) {
      now += milliseconds(1);
      if (now.time_since_epoch() % milliseconds(5) == Duration(0))
        client->channel.service(now), server->channel.service(now);
      send(*client, *server, client_address);
      send(*server, *client, kServerAddress);
    }
  }
  bool both_heard_in(Duration length) {
    const auto c = client->accepted, s = server->accepted;
    run(length);
    return client->accepted > c && server->accepted > s;
  }

  const SideCredentials ours = test_credentials(GetParam(), 1);
  const SideCredentials others = test_credentials(GetParam(), 2);
  TimePoint now{seconds(3600)};
  UdpAddress client_address = kClientAddress;
  std::unique_ptr<End> client, server;
  std::unique_ptr<End> second;  // another client, if any
  End* mute = nullptr;          // nothing from it or to it
  double loss = 0;              // share of all datagrams
  Random random{1};
  const Bytes payload = some_payload(1);
  Bytes last;
};

TEST_P(SecureChannelTest, ConnectsOnceAndStaysConnected) {
  EXPECT_TRUE(both_heard_in(milliseconds(100)));
  run(seconds(20));
  EXPECT_EQ(client->channel.counters().begun, 1u);
  EXPECT_EQ(server->channel.counters().done, 1u);
  EXPECT_GT(server->accepted, 19900u);
}

TEST_P(SecureChannelTest, EitherSideMayRestartFromAnyAddress) {
  ASSERT_TRUE(both_heard_in(milliseconds(100)));
  for (std::uint8_t i = 0; i < 5; ++i) {
    restart(client, true);
    client_address = test_address(10 + i);
    EXPECT_TRUE(both_heard_in(milliseconds(100))) << "client " << i;
    restart(server, false);
    EXPECT_TRUE(both_heard_in(milliseconds(800))) << "server " << i;
  }
}

// 1.9 s for the handshake (Dtls.ConnectsUnderTwentyPercentLossBothWays), 0.5 s of silence before.
TEST_P(SecureChannelTest, EitherSideMayRestartUnderLoss) {
  loss = 0.2;
  EXPECT_TRUE(both_heard_in(seconds(3)));
  for (int i = 0; i < 10; ++i) {
    restart(client, true);
    EXPECT_TRUE(both_heard_in(seconds(3))) << "client " << i;
    restart(server, false);
    EXPECT_TRUE(both_heard_in(seconds(3))) << "server " << i;
  }
}

TEST_P(SecureChannelTest, AnAddressMayChangeUnderASession) {
  ASSERT_TRUE(both_heard_in(milliseconds(100)));
  client_address = test_address(77);
  EXPECT_TRUE(both_heard_in(milliseconds(5)));
  EXPECT_EQ(client->channel.counters().begun, 1u);
}

TEST_P(SecureChannelTest, ComesBackAfterACut) {
  ASSERT_TRUE(both_heard_in(milliseconds(100)));
  mute = server.get();
  run(seconds(20));
  mute = nullptr;
  EXPECT_TRUE(both_heard_in(milliseconds(600)));
  EXPECT_GE(server->channel.counters().done, 1u);
}

TEST_P(SecureChannelTest, AnotherKeyIsNeverHeardAndEndsNothing) {
  ASSERT_TRUE(both_heard_in(milliseconds(100)));
  const auto refused = client->refused + server->refused;
  End stranger(true, others);
  for (int i = 0; i < 10000; ++i) {
    run(milliseconds(1));
    if (i % 5 == 0) stranger.channel.service(now);
    while (const DtlsOutgoing* out = stranger.channel.outgoing())
      server->receive(out->datagram(), test_address(66));
    Bytes record(kMaxDatagramBytes);
    EXPECT_EQ(stranger.channel.seal(some_payload(1), record), 0u);
  }
  EXPECT_EQ(server->channel.counters().done, 1u);
  EXPECT_EQ(client->refused + server->refused, refused);
}

TEST_P(SecureChannelTest, TheOldSessionIsOverWhenTheNewOneStands) {
  ASSERT_TRUE(both_heard_in(milliseconds(100)));
  mute = client.get();  // the last record is on its way for long
  run(milliseconds(1));
  Bytes late(kMaxDatagramBytes);
  late.resize(client->channel.seal(some_payload(2), late));
  mute = nullptr;
  restart(client, true);
  ASSERT_TRUE(both_heard_in(milliseconds(100)));
  for (int i = 0; i < 1000; ++i) {
    const auto before = server->accepted;
    server->receive(late, kClientAddress);
    ASSERT_EQ(server->accepted, before);
  }
}

// The link refuses a second master: it is heard and answered, and the first one does not notice.
TEST_P(SecureChannelTest, ASecondClientWaitsBesideTheFirstUntilItIsTaken) {
  ASSERT_TRUE(both_heard_in(milliseconds(100)));
  server->takes_all = false;
  restart(second, true);
  for (int i = 0; i < 20; ++i) {
    run(milliseconds(5));
    second->channel.service(now);
    send(*second, *server, kSecondAddress);
  }
  const auto heard = server->accepted;
  send(*second, *server, kSecondAddress);
  ASSERT_EQ(server->accepted, heard + 1);
  Bytes answer(kMaxDatagramBytes);
  answer.resize(server->channel.seal_answer(payload, answer));
  const auto answered = second->accepted;
  second->receive(answer, kServerAddress);
  EXPECT_EQ(second->accepted, answered + 1);
  EXPECT_TRUE(both_heard_in(milliseconds(100)));  // what the server says goes to the first

  send(*second, *server, kSecondAddress);
  server->channel.settle();
  const auto first = client->accepted;
  EXPECT_FALSE(both_heard_in(milliseconds(100)));
  EXPECT_EQ(client->accepted, first);
  Bytes record(kMaxDatagramBytes);
  record.resize(server->channel.seal(payload, record));
  second->receive(record, kServerAddress);
  EXPECT_EQ(second->accepted, answered + 2);
  const auto after = server->accepted;
  for (int i = 0; i < 10; ++i) send(*client, *server, kClientAddress);
  EXPECT_EQ(server->accepted, after);  // the old connection is over
}

TEST_P(SecureChannelTest, DataBeforeAConnectionIsRefusedByName) {
  ASSERT_TRUE(both_heard_in(milliseconds(100)));
  End fresh(false, ours);
  fresh.receive(last, kClientAddress);
  EXPECT_EQ(fresh.verdicts[static_cast<std::size_t>(Verdict::not_connected)], 1u);
  const std::array<std::byte, 40> plain{std::byte{'F'}, std::byte{'H'}, std::byte{'L'}};
  fresh.receive(plain, kClientAddress);
  EXPECT_EQ(fresh.verdicts[static_cast<std::size_t>(Verdict::bad_magic)], 1u);
  Bytes record(kMaxDatagramBytes);
  EXPECT_EQ(fresh.channel.seal(some_payload(1), record), 0u);
}

TEST_P(SecureChannelTest, TheLoopsHalfAllocatesNothingEvenInAFloodOfHandshakes) {
  ASSERT_TRUE(both_heard_in(milliseconds(100)));
  DtlsHandshake other(DtlsRole::client, others.client);
  other.start(kServerAddress, now);
  const Bytes hello = all_outgoing(other).at(0);
  Bytes record(kMaxDatagramBytes);
  const auto count = allocations_in([&] {
    for (int i = 0; i < 10000; ++i) {
      server->receive(hello, test_address(66));
      const std::size_t size = client->channel.seal(payload, record);
      server->receive(std::span(record).first(size), kClientAddress);
    }
  });
  EXPECT_EQ(count, 0u);
  EXPECT_TRUE(both_heard_in(milliseconds(10)));
}

// The service on a thread of its own, as in the programs.
TEST_P(SecureChannelTest, TheHalvesMayRunOnTwoThreads) {
  std::atomic<bool> over = false;
  for (int restarts = 0; restarts < 5; ++restarts) {
    restart(client, true);
    over = false;
    std::jthread service([&] {
      while (!over) {
        client->channel.service(std::chrono::steady_clock::now());
        server->channel.service(std::chrono::steady_clock::now());
        std::this_thread::sleep_for(milliseconds(1));
      }
    });
    const auto before = server->accepted;
    while (server->accepted < before + 1000) {
      send(*client, *server, client_address);
      send(*server, *client, kServerAddress);
      std::this_thread::yield();
    }
    over = true;
  }
  EXPECT_GE(server->channel.counters().done, 5u);
}

INSTANTIATE_TEST_SUITE_P(Link, SecureChannelTest, kBothProofs, proof_name);

}  // namespace
}  // namespace farhand
