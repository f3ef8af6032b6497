#include "common/address.hpp"

#include <gtest/gtest.h>

namespace farhand {
namespace {

TEST(Address, SplitsHostAndPort) {
  const auto a = parse_address("10.0.0.2:5555");
  ASSERT_TRUE(a);
  EXPECT_EQ(a->host, "10.0.0.2");
  EXPECT_EQ(a->port, 5555);
  EXPECT_FALSE(a->ipv6);
  EXPECT_FALSE(a->loopback);
}

TEST(Address, TakesBracketsOffIpv6) {
  const auto a = parse_address("[fe80::1%eth0]:65535");
  ASSERT_TRUE(a);
  EXPECT_EQ(a->host, "fe80::1%eth0");
  EXPECT_EQ(a->port, 65535);
  EXPECT_TRUE(a->ipv6);
}

TEST(Address, KnowsLoopback) {
  for (const char* text :
       {"127.0.0.1:0", "127.9.8.7:1", "localhost:1", "[::1]:1", "[::ffff:127.0.0.1]:1"})
    EXPECT_TRUE(parse_address(text) && parse_address(text)->loopback) << text;
  for (const char* text : {"0.0.0.0:0", "[::]:0", "128.0.0.1:1", "[::2]:1", "[::ffff:10.0.0.1]:1"})
    EXPECT_TRUE(parse_address(text) && !parse_address(text)->loopback) << text;
  EXPECT_EQ(parse_address("localhost:7")->host, "127.0.0.1");
}

TEST(Address, RefusesEverythingElse) {
  for (const char* text : {"",
                           ":",
                           ":1",
                           "127.0.0.1",
                           "127.0.0.1:",
                           "127.0.0.1:65536",
                           "127.0.0.1:-1",
                           "127.0.0.1:1 ",
                           " 127.0.0.1:1",
                           "127.0.0.1:+1",
                           "127.0.0.1:0x1",
                           "127.1:1",
                           "256.0.0.1:1",
                           "robot:1",
                           "::1:1",
                           "[::1]",
                           "[::1]1",
                           "[]:1",
                           "[127.0.0.1]:1",
                           "[fe80::1%]:1",
                           "[localhost]:1",
                           "[::1:1"})
    EXPECT_FALSE(parse_address(text)) << text;
  EXPECT_FALSE(parse_address(std::string_view("127.0.0.1\0:1", 12)));
}

}  // namespace
}  // namespace farhand
