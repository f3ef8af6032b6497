#include "common/crc32c.hpp"

#include <array>

#include "common/bytes.hpp"

namespace farhand {
namespace {

constexpr std::uint32_t kPolynomial = 0x82f63b78;  // reflected
constexpr std::size_t kSlices = 8;
using Tables = std::array<std::array<std::uint32_t, 256>, kSlices>;

// tables[k][b]: the remainder of byte b followed by k zero bytes.
constexpr Tables make_tables() {
  Tables t{};
  for (std::uint32_t b = 0; b < 256; ++b) {
    std::uint32_t r = b;
    for (int bit = 0; bit < 8; ++bit) r = (r >> 1) ^ ((r & 1) != 0 ? kPolynomial : 0);
    t[0][b] = r;
  }
  for (std::size_t k = 1; k < kSlices; ++k)
    for (std::size_t b = 0; b < 256; ++b) t[k][b] = (t[k - 1][b] >> 8) ^ t[0][t[k - 1][b] & 0xff];
  return t;
}

constexpr Tables kTables = make_tables();

}  // namespace

std::uint32_t crc32c(std::span<const std::byte> bytes) noexcept {
  std::uint32_t r = ~std::uint32_t{0};
  const std::byte* p = bytes.data();
  std::size_t left = bytes.size();
  for (; left >= kSlices; left -= kSlices, p += kSlices) {
    const std::uint64_t x = load_little_endian<std::uint64_t>(p) ^ r;
    const auto slice = [x](std::size_t k) {
      return kTables[kSlices - 1 - k][(x >> (8 * k)) & 0xff];
    };
    r = slice(0) ^ slice(1) ^ slice(2) ^ slice(3) ^ slice(4) ^ slice(5) ^ slice(6) ^ slice(7);
  }
  for (; left > 0; --left, ++p)
    r = (r >> 8) ^ kTables[0][(r ^ static_cast<std::uint32_t>(*p)) & 0xff];
  return ~r;
}

}  // namespace farhand
