#include "common/relay.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <vector>

namespace farhand {
namespace {

using namespace std::chrono_literals;
using Bytes = std::vector<std::byte>;

const UdpAddress kAnyPort = parse_udp_address("127.0.0.1:0");

// Turns the relay until `to` has a datagram; only a failure takes the whole 5 s.
Bytes pass(Relay& relay, UdpSocket& to) {
  std::array<std::byte, UdpSocket::kReceiveBytes> buffer;
  const TimePoint give_up = std::chrono::steady_clock::now() + 5s;
  for (TimePoint now = give_up - 5s; now < give_up; now = std::chrono::steady_clock::now()) {
    relay.forward(now);
    if (const auto got = to.receive(buffer)) {
      to.set_peer(got->from);
      return {buffer.begin(), buffer.begin() + static_cast<std::ptrdiff_t>(got->size)};
    }
    relay.wait(now + 1ms);
  }
  return {};
}

TEST(Relay, PassesBothWaysAndFollowsAClientThatRestarts) {
  UdpSocket server(kAnyPort);
  Relay relay({.listen = kAnyPort, .server = server.local()});
  for (std::uint8_t client_number = 0; client_number < 3; ++client_number) {
    UdpSocket client(kAnyPort, relay.local());
    for (std::uint8_t i = 0; i < 20; ++i) {
      const Bytes there(50, std::byte{i}), back(80, std::byte{client_number});
      ASSERT_TRUE(client.send(there));
      ASSERT_EQ(pass(relay, server), there);
      ASSERT_TRUE(server.send(back));
      ASSERT_EQ(pass(relay, client), back);
    }
  }
  EXPECT_EQ(relay.to_server().popped, 60u);
  EXPECT_EQ(relay.to_client().popped, 60u);
}

TEST(Relay, EachWayHasItsOwnImpairment) {
  UdpSocket server(kAnyPort);
  Relay relay({.listen = kAnyPort,
               .server = server.local(),
               .to_server = ImpairmentConfig{.duplicate_ratio = 1},
               .to_client = ImpairmentConfig{.loss_ratio = 1}});
  UdpSocket client(kAnyPort, relay.local());
  const Bytes bytes(50, std::byte{7});
  ASSERT_TRUE(client.send(bytes));
  EXPECT_EQ(pass(relay, server), bytes);
  EXPECT_EQ(pass(relay, server), bytes);
  ASSERT_TRUE(server.send(bytes));
  while (relay.to_client().pushed == 0) {
    relay.wait(std::chrono::steady_clock::now() + 5s);
    relay.forward(std::chrono::steady_clock::now());
  }
  EXPECT_EQ(relay.to_client().lost, 1u);
  EXPECT_NE(relay.summary().find("doubled 1"), std::string::npos);
}

}  // namespace
}  // namespace farhand
