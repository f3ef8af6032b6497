// What a server gives to whom: strangers, floods, recorded handshakes, clients that start again.
#include <gtest/gtest.h>

#include <algorithm>

#include "common/dtls.hpp"
#include "tests/support/both_proofs.hpp"
#include "tests/support/dtls_ends.hpp"

namespace farhand {
namespace {

using std::chrono::milliseconds;
using std::chrono::seconds;

constexpr std::size_t kMessageAt = 13, kHelloRandomAt = 27;

bool is_flight(const Bytes& datagram) {
  return datagram.at(kMessageAt) == std::byte{2};  // begins with a ServerHello
}

// A client of the test's own, one message at a time.
class DtlsServer : public testing::TestWithParam<Proof> {
 protected:
  const SideCredentials ours = test_credentials(GetParam(), 1);
  const SideCredentials others = test_credentials(GetParam(), 2);

  // The server's answer to `datagram`.
  std::vector<Bytes> ask(const Bytes& datagram, const UdpAddress& from) {
    server.receive(datagram, from, now);
    return all_outgoing(server);
  }
  static Bytes hello(DtlsHandshake& of, TimePoint at) {
    of.start(kServerAddress, at);
    return all_outgoing(of).at(0);
  }
  Bytes hello_with_cookie(DtlsHandshake& of, const UdpAddress& from) {
    of.receive(ask(hello(of, now), from).at(0), kServerAddress, now);
    return all_outgoing(of).at(0);
  }
  // Goes on with what the server says to `of` until nobody has more to say.
  void converse(DtlsHandshake& of, std::vector<Bytes> said, const UdpAddress& from) {
    while (!said.empty()) {
      std::vector<Bytes> answers;
      for (const Bytes& d : said) {
        of.receive(d, kServerAddress, now);
        for (const Bytes& a : all_outgoing(of)) {
          const auto more = ask(a, from);
          answers.insert(answers.end(), more.begin(), more.end());
        }
      }
      said = answers;
    }
  }
  // A record of a message that belongs nowhere in a handshake that has just begun.
  static Bytes wrong_message() {
    Bytes m{std::byte{22}, std::byte{0xfe}, std::byte{0xfd}};
    m.resize(26);
    m[10] = std::byte{2};   // number of the record
    m[12] = std::byte{13};  // its length
    m[13] = std::byte{16};  // ClientKeyExchange
    m[16] = m[24] = std::byte{1};
    m[18] = std::byte{2};  // number of the message
    m[25] = std::byte{0xff};
    return m;
  }
  struct Said {
    std::uint64_t begun;
    std::size_t flights;
  };
  // Proven hellos of one address in turn, one a millisecond for 20 s, each with `behind` behind it.
  Said played_back(int hellos, const Bytes& behind) {
    std::vector<Bytes> recorded;
    for (int i = 0; i < hellos; ++i) {
      DtlsHandshake one(DtlsRole::client, ours.client);
      recorded.push_back(hello_with_cookie(one, kClientAddress));
    }
    Said said{};
    for (std::size_t i = 0; i < 20000; ++i) {
      now += milliseconds(1);
      const Bytes& hello = recorded[i % recorded.size()];
      server.tick(now);
      said.flights += all_outgoing(server).size();
      for (const Bytes& a : ask(hello, kClientAddress)) said.flights += is_flight(a);
      if (!behind.empty()) ask(behind, kClientAddress);
    }
    said.begun = server.counters().begun;
    return said;
  }
  void connect(DtlsHandshake& of, const UdpAddress& from) {
    const Bytes proven = hello_with_cookie(of, from);
    converse(of, ask(proven, from), from);
  }

  TimePoint now{std::chrono::hours(1)};
  DtlsHandshake server{DtlsRole::server, ours.server};
  DtlsHandshake client{DtlsRole::client, ours.client};
};

TEST_P(DtlsServer, GivesNoMoreThanItGetsBeforeTheCookie) {
  Random random(1);
  const Bytes good = hello(client, now);
  std::size_t answered = 0;
  for (int i = 0; i < 20000; ++i) {
    Bytes d = good;
    const std::size_t flips = random.bits() % 4;
    for (std::size_t f = 0; f < flips; ++f)
      d[random.bits() % d.size()] ^= static_cast<std::byte>(random.bits());
    if (random.bits() % 4 == 0) d.resize(random.bits() % (d.size() + 1));
    const std::size_t said = bytes_in(ask(d, test_address(static_cast<std::uint8_t>(i))));
    ASSERT_LE(said, d.size()) << i;
    answered += said > 0 ? 1 : 0;
  }
  EXPECT_GT(answered, 0u);
  EXPECT_EQ(server.counters().begun, 0u);
}

TEST_P(DtlsServer, TakesACookieFromItsAddressAndTimeOnly) {
  const Bytes proven = hello_with_cookie(client, kClientAddress);
  EXPECT_LE(bytes_in(ask(proven, test_address(9))), proven.size());
  EXPECT_EQ(server.counters().begun, 0u);
  now += std::chrono::minutes(2);
  EXPECT_LE(bytes_in(ask(proven, kClientAddress)), proven.size());
  EXPECT_EQ(server.counters().begun, 0u);
  now -= std::chrono::minutes(2);
  EXPECT_GT(bytes_in(ask(proven, kClientAddress)), 0u);
  EXPECT_EQ(server.counters().begun, 1u);
}

// What a client that proves its address and then keeps silent gets in all.
TEST_P(DtlsServer, SaysLittleToASilentClient) {
  std::size_t got = bytes_in(ask(hello_with_cookie(client, kClientAddress), kClientAddress));
  const std::size_t flight = got;
  for (int i = 0; i < 60000; ++i) {
    now += milliseconds(1);
    server.tick(now);
    got += bytes_in(all_outgoing(server));
  }
  EXPECT_EQ(server.counters().expired, 1u);
  EXPECT_EQ(server.counters().resent, 13u);  // after 0.1, 0.3, 0.7, 1.1, ... 4.7 s
  EXPECT_EQ(got, 14 * flight);
  std::printf("%zu bytes in a flight, %zu in all\n", flight, got);
}

TEST_P(DtlsServer, TakesACookieWithItsHelloOnly) {
  Bytes proven = hello_with_cookie(client, kClientAddress);
  Random random(3);
  std::size_t got = 0;
  for (int i = 0; i < 400; ++i) {
    for (std::size_t b = 0; b < kDtlsRandomBytes; ++b)
      proven[kHelloRandomAt + b] = static_cast<std::byte>(random.bits());
    got += bytes_in(ask(proven, kClientAddress));
  }
  EXPECT_EQ(server.counters().begun, 0u);
  EXPECT_LE(got, 400 * proven.size());
}

// Recorded hellos of one address, played back in turn for 20 s: they are good for 10 s at most and
// begin a handshake every 100 ms, which may have sent its flight again by then; the last one goes
// on to its end.
TEST_P(DtlsServer, SaysLittleToHellosInTurn) {
  const auto [begun, flights] = played_back(3, {});
  std::printf("%llu begun, %zu flights\n", static_cast<unsigned long long>(begun), flights);
  EXPECT_GT(begun, 40u);
  EXPECT_LE(begun, 100u);
  EXPECT_LE(flights, 2 * begun + 12);
}

// The same one again begins nothing before its handshake has ended, after 5 s.
TEST_P(DtlsServer, SaysLittleToOneHelloAgainAndAgain) {
  const auto [begun, flights] = played_back(1, {});
  EXPECT_EQ(begun, 2u);
  EXPECT_EQ(flights, 2u * 14);
}

// With a forged datagram behind each, which makes it fail.
TEST_P(DtlsServer, SaysLittleToHandshakesThatFailInTurn) {
  const auto [begun, flights] = played_back(3, wrong_message());
  std::printf("%llu begun, %zu flights\n", static_cast<unsigned long long>(begun), flights);
  EXPECT_GT(server.counters().failed, 40u);
  EXPECT_LE(begun, 100u);
  EXPECT_LE(flights, begun);
}

// Anyone can ask for it in the client's name.
TEST_P(DtlsServer, SaysItsLastFlightSeldom) {
  connect(client, kClientAddress);
  ASSERT_EQ(server.counters().done, 1u);
  std::size_t resent = 0;
  for (int i = 0; i < 6000; ++i) {
    now += milliseconds(1);
    resent += ask(wrong_message(), kClientAddress).size();
  }
  EXPECT_GT(resent, 50u);
  EXPECT_LE(resent, 100u);  // every 50 ms for 5 s
}

// It sends that until it hears of the new one, so it may come at any time.
TEST_P(DtlsServer, ItsFlightOfAnAttemptBeforeIsNotTakenForAnAnswer) {
  const auto old = ask(hello_with_cookie(client, kClientAddress), kClientAddress);
  const auto unanswered = [&] {
    for (const Bytes& d : old) client.receive(d, kServerAddress, now);
    return all_outgoing(client).empty();
  };
  for (const Duration wait : {Duration(seconds(3)), Duration(milliseconds(400))}) {
    now += wait;
    client.tick(now);
  }
  EXPECT_EQ(client.counters().begun, 2u);
  const Bytes hello = all_outgoing(client).at(0);
  EXPECT_TRUE(unanswered());
  client.receive(ask(hello, kClientAddress).at(0), kServerAddress, now);
  const Bytes proven = all_outgoing(client).at(0);
  EXPECT_TRUE(unanswered());
  converse(client, ask(proven, kClientAddress), kClientAddress);
  EXPECT_EQ(client.counters().done, 1u);
  EXPECT_EQ(server.counters().done, 1u);
}

TEST_P(DtlsServer, AnAlertEndsNothing) {
  const auto alert = [](std::uint8_t about, std::uint8_t sequence) {
    Bytes a{std::byte{21}, std::byte{0xfe}, std::byte{0xfd}};
    a.resize(13);
    a[10] = std::byte{sequence};
    a[12] = std::byte{2};
    a.push_back(std::byte{2});  // fatal
    a.push_back(std::byte{about});
    return a;
  };
  const Bytes proven = hello_with_cookie(client, kClientAddress);
  const auto flight = ask(proven, kClientAddress);
  for (int about = 0; about < 256; ++about) {
    const auto a = alert(static_cast<std::uint8_t>(about), static_cast<std::uint8_t>(about));
    EXPECT_TRUE(ask(a, kClientAddress).empty());
    client.receive(a, kServerAddress, now);
  }
  converse(client, flight, kClientAddress);
  EXPECT_EQ(server.counters().done, 1u);
  EXPECT_EQ(client.counters().done, 1u);
  const auto here = server.take_session(), there = client.take_session();
  Bytes room(kMaxPayloadBytes);
  for (int about = 0; about < 256; ++about)
    EXPECT_EQ(here->open(alert(static_cast<std::uint8_t>(about), 99), room).verdict,
              Verdict::too_short);
  EXPECT_TRUE(passes(*there, *here, 1));
}

TEST_P(DtlsServer, KeepsTheOldSessionUntilTheNewIsAuthentic) {
  connect(client, kClientAddress);
  const auto here = server.take_session(), there = client.take_session();
  ASSERT_TRUE(here && there);

  DtlsHandshake stranger(DtlsRole::client, others.client);
  connect(stranger, test_address(9));
  EXPECT_EQ(server.take_session(), nullptr);
  EXPECT_TRUE(passes(*there, *here, 1));

  for (const UdpAddress& address : {kClientAddress, test_address(7)}) {
    DtlsHandshake restarted(DtlsRole::client, ours.client);
    connect(restarted, address);
    const auto now_here = server.take_session(), now_there = restarted.take_session();
    ASSERT_TRUE(now_here && now_there);
    EXPECT_TRUE(passes(*now_there, *now_here, 2));
    EXPECT_TRUE(passes(*there, *here, 3)) << "the old one is the caller's until it lets go";
    EXPECT_FALSE(passes(*there, *now_here, 4));
    EXPECT_FALSE(passes(*now_there, *here, 5));
  }
}

// A client whose own handshake is under way is not thrown out by one from elsewhere, for a second.
TEST_P(DtlsServer, ProtectsAHandshakeFromOtherAddresses) {
  const Bytes proven = hello_with_cookie(client, kClientAddress);
  DtlsHandshake other(DtlsRole::client, ours.client);
  const Bytes later = hello_with_cookie(other, test_address(9));
  const auto flight = ask(proven, kClientAddress);
  EXPECT_TRUE(ask(later, test_address(9)).empty());
  converse(client, flight, kClientAddress);
  EXPECT_EQ(server.counters().done, 1u);
}

// A stranger who begins again and again does not keep a restarted client out.
TEST_P(DtlsServer, TheHostOfTheLastClientComesFirst) {
  connect(client, kClientAddress);
  UdpAddress restarted_at = kClientAddress;
  ++restarted_at.port;
  DtlsHandshake restarted(DtlsRole::client, ours.client);
  const Bytes proven = hello_with_cookie(restarted, restarted_at);
  DtlsHandshake stranger(DtlsRole::client, others.client), again(DtlsRole::client, others.client);
  const Bytes strange = hello_with_cookie(stranger, test_address(9));
  const Bytes strange_again = hello_with_cookie(again, test_address(10));
  EXPECT_FALSE(ask(strange, test_address(9)).empty());
  const auto flight = ask(proven, restarted_at);
  EXPECT_TRUE(ask(strange_again, test_address(10)).empty());
  converse(restarted, flight, restarted_at);
  EXPECT_EQ(server.counters().done, 2u);
}

TEST_P(DtlsServer, ASilentClientBlocksNobodyForLong) {
  ask(hello_with_cookie(client, kClientAddress), kClientAddress);
  now += seconds(1);
  DtlsHandshake other(DtlsRole::client, ours.client);
  connect(other, test_address(9));
  EXPECT_EQ(server.counters().done, 1u);
}

// OpenSSL alone ends a session for good after a ChangeCipherSpec of the coming epoch in front of a
// Finished, as one flipped bit makes it.
TEST_P(DtlsServer, ASpoiltLastFlightDoesNotDisturbTheSession) {
  constexpr std::size_t kChangeCipherSpecBytes = 14, kEpochAt = 4;
  const auto flight = ask(hello_with_cookie(client, kClientAddress), kClientAddress);
  client.receive(flight.at(0), kServerAddress, now);
  const Bytes last = ask(all_outgoing(client).at(0), kClientAddress).at(0);
  Bytes spoilt = last;
  spoilt[kEpochAt] = std::byte{1};
  client.receive(spoilt, kServerAddress, now);
  client.receive(std::span(last).subspan(kChangeCipherSpecBytes), kServerAddress, now);
  client.receive(last, kServerAddress, now);
  const auto here = server.take_session(), there = client.take_session();
  ASSERT_TRUE(here && there);
  EXPECT_TRUE(passes(*there, *here, 1));
  EXPECT_TRUE(passes(*here, *there, 2));
}

// A whole recorded handshake, sent again from the same address.
TEST_P(DtlsServer, ARecordedHandshakeOpensNothing) {
  DtlsEnds ends(ours);
  ASSERT_TRUE(ends.run(milliseconds(10)));
  for (int again = 0; again < 3; ++again)
    for (const Bytes& d : ends.client_sent) {
      ends.server.receive(d, kClientAddress, ends.now);
      all_outgoing(ends.server);
    }
  EXPECT_EQ(ends.server.counters().done, 1u);
  EXPECT_EQ(ends.server.take_session(), nullptr);
}

TEST_P(DtlsServer, GarbageBeginsNothing) {
  Random random(5);
  for (int i = 0; i < 100000; ++i) {
    Bytes d(random.bits() % 1300);
    for (std::byte& b : d) b = static_cast<std::byte>(random.bits());
    if (d.size() > 13 && i % 2 == 0) {  // a good header
      d[0] = static_cast<std::byte>(20 + random.bits() % 4);
      d[1] = std::byte{0xfe};
      d[2] = std::byte{0xfd};
      d[3] = d[4] = std::byte{0};
      d[11] = static_cast<std::byte>((d.size() - 13) >> 8);
      d[12] = static_cast<std::byte>((d.size() - 13) & 255);
      if (d.size() > 25) d[13] = std::byte{1};
    }
    ASSERT_LE(bytes_in(ask(d, kClientAddress)), d.size());
  }
  EXPECT_EQ(server.counters().begun, 0u);
  connect(client, kClientAddress);
  EXPECT_EQ(server.counters().done, 1u);
}

INSTANTIATE_TEST_SUITE_P(Link, DtlsServer, kBothProofs, proof_name);

}  // namespace
}  // namespace farhand
