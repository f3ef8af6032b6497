#include "common/crc32c.hpp"

#include <gtest/gtest.h>

#include <array>
#include <cstring>
#include <string_view>
#include <vector>

#include "common/random.hpp"

namespace farhand {
namespace {

std::uint32_t of(std::string_view text) {
  return crc32c(std::as_bytes(std::span(text)));
}

// The definition: one bit after the other.
std::uint32_t by_long_division(std::span<const std::byte> bytes) {
  std::uint32_t r = 0xffffffff;
  for (const std::byte b : bytes)
    for (unsigned bit = 0; bit < 8; ++bit) {
      const bool carry = ((r ^ (static_cast<std::uint32_t>(b) >> bit)) & 1) != 0;
      r = (r >> 1) ^ (carry ? 0x82f63b78u : 0u);
    }
  return ~r;
}

TEST(Crc32c, PublishedVectorsComeOut) {  // RFC 3720, B.4
  std::array<char, 32> up{}, down{};
  for (int i = 0; i < 32; ++i) {
    up[static_cast<std::size_t>(i)] = static_cast<char>(i);
    down[static_cast<std::size_t>(i)] = static_cast<char>(31 - i);
  }
  EXPECT_EQ(of(""), 0u);
  EXPECT_EQ(of("123456789"), 0xe3069283u);
  EXPECT_EQ(of(std::string(32, '\0')), 0x8a9136aau);
  EXPECT_EQ(of(std::string(32, '\xff')), 0x62a8ab43u);
  EXPECT_EQ(of({up.data(), up.size()}), 0x46dd794eu);
  EXPECT_EQ(of({down.data(), down.size()}), 0x113fdb5cu);
}

TEST(Crc32c, EveryLengthAndAlignmentAgreesWithLongDivision) {
  Random random(11);
  std::vector<std::byte> bytes(96);
  for (std::byte& b : bytes) b = static_cast<std::byte>(random.bits());
  for (std::size_t from = 0; from < 9; ++from)
    for (std::size_t size = 0; from + size <= bytes.size(); ++size) {
      const auto part = std::span(bytes).subspan(from, size);
      ASSERT_EQ(crc32c(part), by_long_division(part)) << from << " " << size;
    }
}

}  // namespace
}  // namespace farhand
