#include "master/falcon_usb/packet.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <string>
#include <string_view>
#include <vector>

#include "common/random.hpp"

namespace farhand::falcon_usb {
namespace {

std::string text(const Packet& p) {
  return {reinterpret_cast<const char*>(p.data()), p.size()};
}

Packet packet(std::string_view s) {
  Packet p{};
  std::transform(s.begin(), s.end(), p.begin(), [](char c) { return static_cast<std::byte>(c); });
  return p;
}

Answer random_answer(Random& random) {
  const std::uint64_t bits = random.bits();
  return {.encoders = {static_cast<std::int16_t>(bits), static_cast<std::int16_t>(bits >> 16),
                       static_cast<std::int16_t>(bits >> 32)},
          .buttons = static_cast<std::uint8_t>(bits >> 48 & 15),
          .homed = static_cast<std::uint8_t>(bits >> 52 & 7)};
}

// Everything the finder makes of a stream.
std::vector<Answer> found(PacketFinder& finder, std::span<const std::byte> stream) {
  std::vector<Answer> out;
  for (const std::byte b : stream)
    if (const Packet* p = finder.take(b)) out.push_back(decode_answer(*p).value());
  return out;
}

void append(std::vector<std::byte>& stream, const Packet& p) {
  stream.insert(stream.end(), p.begin(), p.end());
}

TEST(FalconPacket, EveryWordComesBackOnEveryAxisBothWays) {
  for (int word = -32768; word <= 32767; ++word) {
    const AxisWords words{static_cast<std::int16_t>(word), static_cast<std::int16_t>(~word),
                          static_cast<std::int16_t>(word / 2)};
    const Command command{.motors = words};
    ASSERT_EQ(decode_command(encode(command)), command);
    const Answer answer{.encoders = words};
    ASSERT_EQ(decode_answer(encode(answer)), answer);
  }
}

// The letters JFKP are the nibbles 9, 5, 10, 15, the least significant first: 0xFA59.
TEST(FalconPacket, AWorkedExample) {
  const Command command{.motors = {-1447, 0, 1}, .homing = true, .leds = kLedRed};
  EXPECT_EQ(text(encode(command)), "<JFKPAAAABAAAJA>");
  EXPECT_EQ(decode_answer(packet("<JFKPAAAABAAAvA>")),
            (Answer{.encoders = {-1447, 0, 1}, .buttons = 5, .homed = 3}));
}

TEST(FalconPacket, FlagsOfEveryKindComeBack) {
  for (unsigned flags = 0; flags < 128; ++flags) {
    const Answer answer{.buttons = static_cast<std::uint8_t>(flags & 15),
                        .homed = static_cast<std::uint8_t>(flags >> 4)};
    EXPECT_EQ(std::to_integer<unsigned>(encode(answer)[13]), 'A' + flags);
    EXPECT_EQ(decode_answer(encode(answer)), answer);
  }
  for (unsigned flags = 0; flags < 16; ++flags) {
    const Command command{.homing = (flags & 1) != 0,
                          .leds = static_cast<std::uint8_t>(flags & 14)};
    EXPECT_EQ(std::to_integer<unsigned>(encode(command)[13]), 'A' + flags);
    EXPECT_EQ(decode_command(encode(command)), command);
  }
}

TEST(FalconPacket, OnlyTheSpareByteMayBeAnything) {
  const Packet good = encode(Answer{.encoders = {1, -2, 3}, .homed = kAllHomed});
  for (std::size_t place = 0; place < kPacketBytes; ++place) {
    unsigned accepted = 0;
    for (unsigned value = 0; value < 256; ++value) {
      Packet changed = good;
      changed[place] = static_cast<std::byte>(value);
      accepted += decode_answer(changed).has_value();
    }
    const bool bracket = place == 0 || place == 15;
    EXPECT_EQ(accepted, bracket ? 1u : place == 13 ? 128u : place == 14 ? 256u : 16u) << place;
  }
}

TEST(FalconPacket, ACommandWithAnAnswersFlagsIsRefused) {
  EXPECT_FALSE(decode_command(encode(Answer{.homed = 1})));
}

TEST(PacketFinder, FindsPacketsHoweverTheStreamIsCutOrFilled) {
  Random random(3);
  PacketFinder finder;
  for (int i = 0; i < 20000; ++i) {
    const Answer answer = random_answer(random);
    std::vector<std::byte> stream;
    for (std::uint64_t n = random.bits() % 24; n > 0; --n)
      stream.push_back(static_cast<std::byte>(random.bits() | 0x80));  // no bracket, no letter
    const std::uint64_t skipped = finder.skipped() + stream.size();
    append(stream, encode(answer));
    ASSERT_EQ(found(finder, stream), std::vector{answer}) << i;
    ASSERT_EQ(finder.skipped(), skipped);
  }
}

TEST(PacketFinder, APacketCutShortCostsOnlyItself) {
  Random random(4);
  for (std::size_t kept = 0; kept < kPacketBytes; ++kept) {
    PacketFinder finder;
    const Answer first = random_answer(random), second = random_answer(random);
    std::vector<std::byte> stream;
    append(stream, encode(first));
    stream.resize(kept);
    append(stream, encode(second));
    EXPECT_EQ(found(finder, stream), std::vector{second}) << kept;
    EXPECT_EQ(finder.skipped(), kept);
  }
}

TEST(PacketFinder, AByteMissingInTheMiddleNeverMakesAnotherPacketOfTwo) {
  Random random(5);
  for (std::size_t missing = 0; missing < kPacketBytes; ++missing) {
    PacketFinder finder;
    const Answer first = random_answer(random), second = random_answer(random);
    std::vector<std::byte> stream;
    append(stream, encode(first));
    stream.erase(stream.begin() + static_cast<std::ptrdiff_t>(missing));
    append(stream, encode(second));
    EXPECT_EQ(found(finder, stream), std::vector{second}) << missing;
  }
}

// Whatever comes, every packet found is one that decodes, and none is found in what holds none.
TEST(PacketFinder, RandomLettersAndBracketsYieldOnlyWhatDecodes) {
  Random random(6);
  PacketFinder finder;
  std::size_t packets = 0;
  for (int i = 0; i < 2000000; ++i) {
    const std::uint64_t bits = random.bits();
    const unsigned kind = bits % 32;
    const unsigned value = kind == 0 ? '<' : kind == 1 ? '>' : 'A' + (bits >> 8) % 16;
    const Packet* p = finder.take(static_cast<std::byte>(value));
    if (p == nullptr) continue;
    ++packets;
    ASSERT_TRUE(decode_answer(*p));
  }
  EXPECT_GT(packets, 0u);
}

}  // namespace
}  // namespace farhand::falcon_usb
