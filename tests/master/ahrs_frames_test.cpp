#include <cstdio>
#include <string_view>
#include <vector>

#include "common/random.hpp"
#include "master/ahrs/frames.hpp"

namespace farhand {
namespace {

using ByteList = std::vector<std::byte>;

constexpr AhrsFormat kFormats[] = {AhrsFormat::native, AhrsFormat::vectornav, AhrsFormat::text};

AhrsSample random_sample(Random& random) {
  const auto vector = [&](double size) {
    const double x = random.normal(), y = random.normal(), z = random.normal();
    return Vec3(size * Vec3(x, y, z));
  };
  AhrsSample s{
      .gyro = vector(2), .acceleration = vector(8), .time = Duration(1000 * (random.bits() >> 20))};
  if (random.bits() % 2) s.magnetic = vector(3e-5);
  if (random.bits() % 2) s.attitude = Quat(rotation(vector(1)));
  return s;
}

ByteList bytes_of(std::string_view text) {
  ByteList out;
  for (const char c : text) out.push_back(static_cast<std::byte>(c));
  return out;
}

ByteList frame(const AhrsSample& s, AhrsFormat format) {
  std::array<std::byte, kMaxFrameBytes> buffer;
  const std::size_t size = encode(s, format, buffer);
  return {buffer.begin(), buffer.begin() + size};
}

std::vector<AhrsSample> parsed(AhrsParser& parser, std::span<const std::byte> bytes) {
  std::vector<AhrsSample> out;
  parser.push(bytes);
  while (const auto s = parser.next()) out.push_back(*s);
  return out;
}

// As well as the format's digits can say it.
bool same(const AhrsSample& a, const AhrsSample& b, AhrsFormat format) {
  const bool text = format == AhrsFormat::text;
  const auto near = [](const Vec3& x, const Vec3& y, double step) {
    return (x - y).cwiseAbs().maxCoeff() <= step;
  };
  if (!near(a.gyro, b.gyro, text ? 5.1e-7 : 2e-6)) return false;
  if (!near(a.acceleration, b.acceleration, text ? 5.1e-4 : 5e-6)) return false;
  if (!near(a.magnetic.value_or(Vec3::Zero()), b.magnetic.value_or(Vec3::Zero()),
            text ? 5.1e-9 : 1e-11))
    return false;
  if (text) return true;
  if (a.attitude.has_value() != b.attitude.has_value() ||
      a.magnetic.has_value() != b.magnetic.has_value())
    return false;
  return a.time == b.time && (!a.attitude || a.attitude->angularDistance(*b.attitude) < 1e-6);
}

TEST(AhrsFrames, WhatIsWrittenIsReadBackHoweverTheBytesAreCut) {
  for (const AhrsFormat format : kFormats) {
    constexpr std::uint64_t kSeed = 1;
    Random random(kSeed);
    AhrsParser parser(format);
    std::vector<AhrsSample> sent, got;
    ByteList stream;
    for (int i = 0; i < 2000; ++i) {
      sent.push_back(random_sample(random));
      const ByteList f = frame(sent.back(), format);
      stream.insert(stream.end(), f.begin(), f.end());
    }
    for (std::size_t at = 0; at < stream.size();) {
      const std::size_t size = std::min<std::size_t>(random.bits() % 300, stream.size() - at);
      for (const AhrsSample& s : parsed(parser, std::span(stream).subspan(at, size)))
        got.push_back(s);
      at += size;
    }
    ASSERT_EQ(got.size(), sent.size()) << "seed " << kSeed;
    for (std::size_t i = 0; i < got.size(); ++i) EXPECT_TRUE(same(got[i], sent[i], format)) << i;
    EXPECT_EQ(parser.foreign(), 0u);
  }
}

// Two sentences and a packet that others have published.
TEST(AhrsFrames, PublishedExamplesAreRead) {
  AhrsParser text(AhrsFormat::text);
  const auto ymr =
      parsed(text, bytes_of("$VNYMR,+100.949,-007.330,+000.715,-00.0049,-00.2449,+00.5397,"
                            "-01.258,-00.100,-09.701,-00.000018,+00.001122,-00.000551*69\r\n"));
  ASSERT_EQ(ymr.size(), 1u);
  EXPECT_EQ(ymr[0].acceleration, Vec3(-1.258, -0.1, -9.701));
  EXPECT_EQ(ymr[0].gyro, Vec3(-0.000018, 0.001122, -0.000551));
  EXPECT_NEAR((*ymr[0].magnetic - Vec3(-4.9e-7, -2.449e-5, 5.397e-5)).norm(), 0, 1e-15);
  // At rest the acceleration points up: that of the reported attitude, whose third axis is down.
  const Vec3 up = *ymr[0].attitude * ymr[0].acceleration.normalized();
  EXPECT_NEAR((up - Vec3(0, 0, -1)).norm(), 0, 0.02);
  EXPECT_EQ(
      parsed(text, bytes_of("$VNYMR,-078.104,+005.642,+023.096,+00.0125,+00.1252,-00.1042,"
                            "+00.878,-03.762,-08.854,-00.010387,-00.028062,-00.061305*68\r\n"))
          .size(),
      1u);

  // Yaw, pitch and roll alone: a frame, and no sample.
  const unsigned char ypr[] = {0xfa, 0x01, 0x08, 0x00, 0x93, 0x50, 0x2e, 0x42, 0x83,
                               0x3e, 0xf1, 0x3f, 0x48, 0xb5, 0x04, 0xbb, 0x92, 0x88};
  AhrsParser binary(AhrsFormat::vectornav);
  EXPECT_TRUE(parsed(binary, std::as_bytes(std::span(ypr))).empty());
  EXPECT_EQ(binary.foreign(), 1u);
  EXPECT_EQ(binary.skipped(), 0u);
}

TEST(AhrsFrames, NoTwoChangedBitsMakeAnotherSampleOfABinaryFrame) {
  for (const AhrsFormat format : {AhrsFormat::native, AhrsFormat::vectornav}) {
    Random random(2);
    AhrsSample sent = random_sample(random);
    sent.magnetic.reset();
    sent.attitude.reset();
    const ByteList good = frame(sent, format);
    const std::size_t bits = 8 * good.size();
    for (std::size_t i = 0; i < bits; ++i)
      for (std::size_t j = i; j < bits; ++j) {
        ByteList bad = good;
        bad[i / 8] ^= std::byte{1} << (i % 8);
        if (j > i) bad[j / 8] ^= std::byte{1} << (j % 8);
        AhrsParser parser(format);
        ASSERT_TRUE(parsed(parser, bad).empty()) << i << ' ' << j;
      }
  }
}

TEST(AhrsFrames, NoChangedBitMakesAnotherSampleOfASentence) {
  Random random(3);
  const ByteList good = frame(random_sample(random), AhrsFormat::text);
  for (std::size_t i = 0; i < 8 * (good.size() - 2); ++i) {
    ByteList bad = good;
    bad[i / 8] ^= std::byte{1} << (i % 8);
    AhrsParser parser(AhrsFormat::text);
    for (const AhrsSample& s : parsed(parser, bad)) {
      // Only a hexadecimal digit of the checksum in the other case is still the same sentence.
      AhrsParser again(AhrsFormat::text);
      EXPECT_TRUE(same(s, parsed(again, good).at(0), AhrsFormat::text)) << i;
      EXPECT_GE(i / 8, good.size() - 4);
    }
  }
}

// A line that loses, doubles, changes and invents bytes: every sample that comes out was sent.
TEST(AhrsFrames, ABadLineCostsSamplesAndInventsNone) {
  for (const AhrsFormat format : kFormats) {
    constexpr std::uint64_t kSeed = 4;
    Random random(kSeed);
    AhrsParser parser(format);
    std::vector<AhrsSample> sent;
    std::size_t got = 0, wrong = 0, next = 0;
    int whole = 0;
    for (int i = 0; i < 20'000; ++i) {
      sent.push_back(random_sample(random));
      ByteList f = frame(sent.back(), format);
      bool hurt = false;
      if (random.uniform() < 0.2) {
        hurt = true;
        const std::size_t at = random.bits() % f.size();
        switch (random.bits() % 4) {
          case 0:
            f.resize(at);
            break;
          case 1:
            f.insert(f.begin() + at, static_cast<std::byte>(random.bits()));
            break;
          case 2:
            f[at] ^= static_cast<std::byte>(1 + random.bits() % 255);
            break;
          default:
            f.erase(f.begin() + at);
            break;
        }
      }
      whole += !hurt;
      for (const AhrsSample& s : parsed(parser, f)) {
        ++got;
        while (next < sent.size() && !same(s, sent[next], format)) ++next;
        wrong += next == sent.size();
        if (next == sent.size()) next = 0;
      }
    }
    std::printf("ahrs frames %d: %zu of %d whole ones read, %zu wrong, %llu bytes skipped\n",
                static_cast<int>(format), got, whole, wrong,
                static_cast<unsigned long long>(parser.skipped()));
    EXPECT_EQ(wrong, 0u) << "seed " << kSeed;
    EXPECT_GE(got, static_cast<std::size_t>(0.99 * whole)) << "seed " << kSeed;
  }
}

TEST(AhrsFrames, NoiseIsHeldWithinBoundsAndGivesNothing) {
  for (const AhrsFormat format : kFormats) {
    Random random(5);
    AhrsParser parser(format);
    std::uint64_t pushed = 0;
    for (int i = 0; i < 20'000; ++i) {
      ByteList noise(random.bits() % 1200);
      for (std::byte& b : noise) b = static_cast<std::byte>(random.bits());
      pushed += noise.size();
      ASSERT_TRUE(parsed(parser, noise).empty());
    }
    EXPECT_GE(parser.skipped() + parser.foreign() * kMaxFrameBytes + 4 * kMaxFrameBytes, pushed);
    const AhrsSample s{.acceleration = Vec3(0, 9.81, 0)};
    std::size_t found = 0;
    for (int i = 0; i < 10; ++i) found += parsed(parser, frame(s, format)).size();
    EXPECT_GE(found, 5u);  // what looked like the begin of a long frame may hide the first ones
  }
}

TEST(AhrsFrames, WhatNoSensorReadsIsRefusedThoughItsChecksumIsRight) {
  for (const AhrsFormat format : {AhrsFormat::native, AhrsFormat::vectornav}) {
    AhrsParser parser(format);
    EXPECT_TRUE(parsed(parser, frame({.gyro = Vec3(NAN, 0, 0)}, format)).empty());
    EXPECT_TRUE(parsed(parser, frame({.acceleration = Vec3(0, 2000, 0)}, format)).empty());
    EXPECT_EQ(parser.foreign(), 2u);
    EXPECT_EQ(parsed(parser, frame({}, format)).size(), 1u);
  }
}

}  // namespace
}  // namespace farhand
