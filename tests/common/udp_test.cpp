#include "common/udp.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <numeric>
#include <stdexcept>
#include <vector>

#include "common/link.hpp"
#include "tests/support/allocations.hpp"

namespace farhand {
namespace {

using namespace std::chrono_literals;
using Bytes = std::vector<std::byte>;
using Buffer = std::array<std::byte, UdpSocket::kReceiveBytes>;

const UdpAddress kAnyPort = parse_udp_address("127.0.0.1:0");

TimePoint clock_now() {
  return std::chrono::steady_clock::now();
}

// Waits generously: only a failure takes this long.
std::optional<UdpSocket::Received> receive_soon(UdpSocket& socket, Buffer& buffer) {
  socket.wait_readable(clock_now() + 5s);
  return socket.receive(buffer);
}

Bytes pattern(std::size_t size) {
  Bytes out(size);
  for (std::size_t i = 0; i < size; ++i) out[i] = static_cast<std::byte>(i * 7 + size);
  return out;
}

std::string refusal(const auto& f) {
  try {
    f();
  } catch (const std::exception& e) {
    return e.what();
  }
  return "";
}

TEST(UdpAddress, ComesBackAsWritten) {
  for (const char* text : {"127.0.0.1:5555", "0.0.0.0:0", "255.255.255.255:65535", "[::1]:1",
                           "[2001:db8::7]:443", "[fe80::1%lo]:9"})
    EXPECT_EQ(to_string(parse_udp_address(text)), text);
  EXPECT_EQ(parse_udp_address("127.0.0.1:80"), parse_udp_address("127.0.0.1:80"));
  EXPECT_FALSE(parse_udp_address("127.0.0.1:80") == parse_udp_address("127.0.0.1:81"));
}

TEST(UdpAddress, WhatIsNoneIsRefusedWithTheTextAndAnExample) {
  for (const char* text :
       {"", ":", "127.0.0.1", "127.0.0.1:", "127.0.0.1:65536", "127.0.0.1:-1", "127.0.0.1:80x",
        "robot:5555", "256.0.0.1:1", "::1:5", "[::1]", "[]:1", "[127.0.0.1]:1", " 127.0.0.1:1"}) {
    const std::string why = refusal([&] { parse_udp_address(text); });
    EXPECT_NE(why.find("'" + std::string(text) + "'"), std::string::npos) << text;
    EXPECT_NE(why.find("10.0.0.2:5555"), std::string::npos) << text;
  }
}

TEST(UdpSocket, TwoOfThemExchangeEverySize) {
  UdpSocket a(kAnyPort), b(kAnyPort);
  a.set_peer(b.local());
  b.set_peer(a.local());
  Buffer buffer;
  for (std::size_t size = 1; size <= kMaxDatagramBytes; size += 109) {
    for (auto [from, to] : {std::pair{&a, &b}, {&b, &a}}) {
      const Bytes sent = pattern(size);
      ASSERT_TRUE(from->send(sent));
      const auto got = receive_soon(*to, buffer);
      ASSERT_TRUE(got.has_value());
      ASSERT_EQ(got->size, size);
      ASSERT_EQ(got->from, from->local());
      ASSERT_TRUE(std::equal(sent.begin(), sent.end(), buffer.begin()));
    }
  }
  EXPECT_EQ(a.counters().sent, b.counters().received);
  EXPECT_EQ(b.counters().sent, a.counters().received);
}

TEST(UdpSocket, WorksOverIpv6) {
  std::optional<UdpSocket> a, b;
  try {
    a.emplace(parse_udp_address("[::1]:0"));
    b.emplace(parse_udp_address("[::1]:0"), a->local());
  } catch (const std::runtime_error& e) {
    GTEST_SKIP() << "no IPv6 here: " << e.what();
  }
  Buffer buffer;
  ASSERT_TRUE(b->send(pattern(50)));
  const auto got = receive_soon(*a, buffer);
  ASSERT_TRUE(got.has_value());
  EXPECT_EQ(got->from, b->local());
}

TEST(UdpSocket, GivesNothingWhenThereIsNothing) {
  UdpSocket a(kAnyPort);
  Buffer buffer;
  EXPECT_FALSE(a.receive(buffer).has_value());
  const TimePoint deadline = clock_now() + 3ms;
  EXPECT_FALSE(a.wait_readable(deadline));
  EXPECT_GE(clock_now(), deadline);  // not before
  EXPECT_FALSE(a.wait_readable(deadline - 1h));
}

TEST(UdpSocket, SpinsUntilSomethingComesOrTheDeadline) {
  UdpSocket a(kAnyPort);
  const TimePoint deadline = clock_now() + 3ms;
  EXPECT_FALSE(a.spin_readable(deadline));
  EXPECT_GE(clock_now(), deadline);
  EXPECT_FALSE(a.spin_readable(deadline - 1h));
  UdpSocket b(kAnyPort, a.local());
  ASSERT_TRUE(b.send(pattern(10)));
  EXPECT_TRUE(a.spin_readable(clock_now() + 5s));
}

TEST(UdpSocket, ADeadlineSetAheadEndsTheWaitUnlessSomethingComes) {
  UdpSocket a(kAnyPort), b(kAnyPort, a.local());
  Buffer buffer;
  const TimePoint deadline = clock_now() + 3ms;
  a.set_deadline(deadline);
  EXPECT_FALSE(a.wait_readable());
  EXPECT_GE(clock_now(), deadline);  // not before
  EXPECT_FALSE(a.wait_readable());   // it stays over

  a.set_deadline(clock_now() + 1h);
  ASSERT_TRUE(b.send(pattern(10)));
  EXPECT_TRUE(a.wait_readable());
  EXPECT_TRUE(a.receive(buffer).has_value());

  a.set_deadline(TimePoint{});  // long over
  EXPECT_FALSE(a.wait_readable());
  ASSERT_TRUE(b.send(pattern(10)));
  EXPECT_TRUE(a.wait_readable());  // what is there counts, over or not
}

TEST(UdpSocket, WithoutAPeerNothingIsSent) {
  UdpSocket a(kAnyPort);
  EXPECT_FALSE(a.send(pattern(10)));
  EXPECT_FALSE(a.send({}));
  EXPECT_EQ(a.counters().send_failed, 1u);
  EXPECT_EQ(a.counters().sent, 0u);
}

TEST(UdpSocket, ReachesOthersThanItsPeerAndKeepsIt) {
  UdpSocket a(kAnyPort), b(kAnyPort), c(kAnyPort);
  Buffer buffer;
  EXPECT_TRUE(a.send_to(pattern(3), b.local()));
  EXPECT_TRUE(receive_soon(b, buffer));
  EXPECT_FALSE(a.peer());
  a.set_peer(b.local());
  EXPECT_TRUE(a.send_to(pattern(3), c.local()));
  EXPECT_TRUE(receive_soon(c, buffer));
  EXPECT_EQ(a.peer(), b.local());
  EXPECT_TRUE(a.send(pattern(3)));
  EXPECT_TRUE(receive_soon(b, buffer));
  UdpSocket fixed(kAnyPort, b.local());
  EXPECT_TRUE(fixed.send_to(pattern(3), c.local()));
  EXPECT_TRUE(receive_soon(b, buffer));
}

TEST(UdpSocket, ADatagramTooLongShowsAsSuch) {
  UdpSocket a(kAnyPort), b(kAnyPort, a.local());
  Buffer buffer;
  ASSERT_TRUE(b.send(pattern(3000)));
  const auto got = receive_soon(a, buffer);
  ASSERT_TRUE(got.has_value());
  EXPECT_GT(got->size, kMaxDatagramBytes);
}

TEST(UdpSocket, AFixedPeerKeepsOthersOutAndStays) {
  UdpSocket friendly(kAnyPort), stranger(kAnyPort);
  UdpSocket socket(kAnyPort, friendly.local());
  socket.set_peer(stranger.local());
  EXPECT_EQ(socket.peer(), friendly.local());
  friendly.set_peer(socket.local());
  stranger.set_peer(socket.local());
  ASSERT_TRUE(stranger.send(pattern(10)));
  ASSERT_TRUE(friendly.send(pattern(20)));
  Buffer buffer;
  const auto got = receive_soon(socket, buffer);
  ASSERT_TRUE(got.has_value());
  EXPECT_EQ(got->size, 20u);
  EXPECT_FALSE(socket.receive(buffer).has_value());
}

TEST(UdpSocket, ADeadPeersRefusalIsCountedAndTheNextOneHeard) {
  std::optional<UdpSocket> peer(kAnyPort);
  const UdpAddress address = peer->local();
  UdpSocket socket(kAnyPort, address);
  peer.reset();
  Buffer buffer;
  for (int i = 0; i < 20; ++i) {
    socket.send(pattern(10));
    EXPECT_TRUE(socket.wait_readable(clock_now() + 5s));  // the refusal
    EXPECT_FALSE(socket.receive(buffer).has_value());
  }
  EXPECT_GE(socket.counters().refused, 20u);
  EXPECT_EQ(socket.counters().receive_failed, 0u);
  peer.emplace(address, socket.local());
  ASSERT_TRUE(socket.send(pattern(30)));
  ASSERT_TRUE(receive_soon(*peer, buffer).has_value());
  ASSERT_TRUE(peer->send(pattern(40)));
  const auto got = receive_soon(socket, buffer);
  ASSERT_TRUE(got.has_value());
  EXPECT_EQ(got->size, 40u);
}

TEST(UdpSocket, AFloodIsDroppedNotBlockedOn) {
  UdpSocket a(kAnyPort), b(kAnyPort, a.local());
  constexpr std::uint64_t kCount = 20000;
  std::uint64_t sent = 0, got = 0;
  const Bytes bytes = pattern(kMaxDatagramBytes);
  for (std::uint64_t i = 0; i < kCount; ++i) sent += b.send(bytes);
  Buffer buffer;
  while (a.receive(buffer)) ++got;
  EXPECT_GT(got, 0u);
  EXPECT_LT(got, kCount);  // the receiver's buffer is finite
  const UdpCounters& c = b.counters();
  EXPECT_EQ(c.sent, sent);
  EXPECT_EQ(c.sent + c.send_would_block + c.send_failed, kCount);
}

TEST(UdpSocket, ThatCannotBeOpenedSaysWhichAddressAndWhatToDo) {
  UdpSocket a(kAnyPort);
  const std::string taken = refusal([&] { UdpSocket b(a.local()); });
  EXPECT_NE(taken.find(to_string(a.local())), std::string::npos) << taken;
  EXPECT_NE(taken.find("another port"), std::string::npos) << taken;
  const std::string away = refusal([&] { UdpSocket b(parse_udp_address("192.0.2.1:5555")); });
  EXPECT_NE(away.find("192.0.2.1:5555"), std::string::npos) << away;
  EXPECT_NE(away.find("0.0.0.0"), std::string::npos) << away;
}

TEST(UdpSocket, TakesNothingFromTheHeapOnceOpen) {
  UdpSocket a(kAnyPort), b(kAnyPort);
  const Bytes bytes = pattern(200);
  Buffer buffer;
  EXPECT_EQ(allocations_in([&] {
              for (int i = 0; i < 200; ++i) {
                b.set_peer(a.local());
                b.send(bytes);
                a.wait_readable(clock_now() + 5s);
                a.receive(buffer);
                a.receive(buffer);
                a.wait_readable(clock_now());
              }
            }),
            0u);
  EXPECT_EQ(a.counters().received, 200u);
}

// The shell's part in short: the slave learns its master's address from what the link accepts.
TEST(UdpSocket, CarriesTwoLinks) {
  UdpSocket slave_socket(kAnyPort), master_socket(kAnyPort, slave_socket.local());
  UdpSocket stranger(kAnyPort, slave_socket.local());
  MasterLink master({.session = 1, .scene_hash = 3});
  SlaveLink slave({.session = 2, .scene_hash = 3});
  const auto step = [](auto& link, UdpSocket& socket, const auto& message) {
    Buffer buffer;
    socket.wait_readable(clock_now() + 1ms);
    while (const auto got = socket.receive(buffer)) {
      const auto datagram = std::span<const std::byte>(buffer).first(got->size);
      if (link.receive(datagram, clock_now()) == Verdict::accepted) socket.set_peer(got->from);
    }
    for (const auto bytes : {link.hello_due(clock_now()), link.encode(message, clock_now())})
      if (!bytes.empty()) socket.send(bytes);
  };
  for (int i = 0; i < 2000 && slave.counters().accepted() < 100; ++i) {
    stranger.send(pattern(50));
    step(master, master_socket, MasterToSlave{});
    step(slave, slave_socket, SlaveToMaster{});
  }
  EXPECT_TRUE(master.connected() && slave.connected());
  EXPECT_GE(slave.counters().accepted(), 100u);
  EXPECT_EQ(slave_socket.peer(), master_socket.local());
  EXPECT_GE(slave.counters()[Verdict::bad_magic], 100u);
  for (const ClockEstimate& clock : {master.clock(), slave.clock()})  // one clock: no offset
    EXPECT_LE(std::chrono::abs(clock.offset), clock.uncertainty);
}

}  // namespace
}  // namespace farhand
