#include "common/channel.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <vector>

#include "common/bytes.hpp"
#include "common/crc32c.hpp"
#include "common/random.hpp"

namespace farhand::channel_test {
namespace {

using Bytes = std::vector<std::byte>;

Bytes random_bytes(Random& random, std::size_t size) {
  Bytes out(size);
  for (std::byte& b : out) b = static_cast<std::byte>(random.bits());
  return out;
}

Bytes sealed(const Bytes& payload) {
  Bytes out(kMaxDatagramBytes);
  out.resize(seal(payload, out));
  return out;
}

Verdict verdict(const Bytes& datagram) {
  std::array<std::byte, kMaxPayloadBytes> payload;
  return open(datagram, payload).verdict;
}

TEST(Channel, EveryPayloadSizeComesBackAsItWas) {
  Random random(1);
  std::array<std::byte, kMaxPayloadBytes> out;
  for (std::size_t size = 1; size <= kMaxPayloadBytes; ++size) {
    const Bytes payload = random_bytes(random, size), datagram = sealed(payload);
    ASSERT_EQ(datagram.size(), size + kChannelHeaderBytes + kChannelTrailerBytes);
    const Opened opened = open(datagram, out);
    ASSERT_EQ(opened.verdict, Verdict::accepted) << size;
    ASSERT_TRUE(std::equal(payload.begin(), payload.end(), out.begin(), out.begin() + opened.size));
  }
}

TEST(Channel, WhatDoesNotFitIsNotSealed) {
  Bytes out(kMaxDatagramBytes);
  EXPECT_EQ(seal({}, out), 0u);
  EXPECT_EQ(seal(Bytes(kMaxPayloadBytes + 1), out), 0u);
  EXPECT_EQ(seal(Bytes(10), std::span(out).first(19)), 0u);
  EXPECT_EQ(seal(Bytes(10), std::span(out).first(20)), 20u);
}

TEST(Channel, EachFaultHasItsName) {
  Random random(2);
  const Bytes good = sealed(random_bytes(random, 100));
  Bytes bad = good;
  bad[0] ^= std::byte{1};
  EXPECT_EQ(verdict(bad), Verdict::bad_magic);
  bad = good;
  bad.pop_back();
  EXPECT_EQ(verdict(bad), Verdict::bad_length);
  bad = good;
  bad.push_back(std::byte{0});
  EXPECT_EQ(verdict(bad), Verdict::bad_length);
  bad = good;
  bad[50] ^= std::byte{4};
  EXPECT_EQ(verdict(bad), Verdict::bad_checksum);
  EXPECT_EQ(verdict({}), Verdict::too_short);
  EXPECT_EQ(verdict(Bytes(good.begin(), good.begin() + 10)), Verdict::too_short);
  EXPECT_EQ(verdict(Bytes(kMaxDatagramBytes + 1)), Verdict::too_long);
}

TEST(Channel, EveryPairOfFlippedBitsIsFound) {
  Random random(3);
  Bytes datagram = sealed(random_bytes(random, 30));
  const std::size_t bits = datagram.size() * 8;
  const auto flip = [&](std::size_t i) {
    datagram[i / 8] ^= std::byte{1} << static_cast<int>(i % 8);
  };
  for (std::size_t i = 0; i < bits; ++i) {
    flip(i);
    ASSERT_NE(verdict(datagram), Verdict::accepted) << i;
    for (std::size_t k = i + 1; k < bits; ++k) {
      flip(k);
      ASSERT_NE(verdict(datagram), Verdict::accepted) << i << " " << k;
      flip(k);
    }
    flip(i);
  }
  EXPECT_EQ(verdict(datagram), Verdict::accepted);
}

TEST(Channel, TheFrameIsLaidOutAsDocumented) {
  const Bytes datagram = sealed({std::byte{0xab}, std::byte{0xcd}});
  const Bytes head = {std::byte{'F'}, std::byte{'H'}, std::byte{'L'},  std::byte{'1'},
                      std::byte{2},   std::byte{0},   std::byte{0xab}, std::byte{0xcd}};
  ASSERT_EQ(datagram.size(), 12u);
  EXPECT_TRUE(std::equal(head.begin(), head.end(), datagram.begin()));
  EXPECT_EQ(load_little_endian<std::uint32_t>(&datagram[8]), crc32c(head));
}

}  // namespace
}  // namespace farhand::channel_test
