#include "common/channel.hpp"

#include <algorithm>

#include "common/bytes.hpp"
#include "common/crc32c.hpp"

namespace farhand {
namespace {

constexpr std::size_t kOverhead = kChannelHeaderBytes + kChannelTrailerBytes;
constexpr std::size_t kLengthAt = 4;

}  // namespace

std::size_t seal(std::span<const std::byte> payload, std::span<std::byte> datagram) noexcept {
  const std::size_t size = payload.size() + kOverhead;
  if (payload.empty() || payload.size() > kMaxPayloadBytes || size > datagram.size()) return 0;
  store_little_endian(kMagic, datagram.data());
  store_little_endian(static_cast<std::uint16_t>(payload.size()), &datagram[kLengthAt]);
  std::copy(payload.begin(), payload.end(), &datagram[kChannelHeaderBytes]);
  const std::size_t body = size - kChannelTrailerBytes;
  store_little_endian(crc32c(datagram.first(body)), &datagram[body]);
  return size;
}

Opened open(std::span<const std::byte> datagram, std::span<std::byte> payload) noexcept {
  if (datagram.size() <= kOverhead) return {Verdict::too_short};
  if (datagram.size() > kMaxDatagramBytes) return {Verdict::too_long};
  if (load_little_endian<std::uint32_t>(datagram.data()) != kMagic) return {Verdict::bad_magic};
  const std::size_t size = datagram.size() - kOverhead;
  if (load_little_endian<std::uint16_t>(&datagram[kLengthAt]) != size || size > payload.size())
    return {Verdict::bad_length};
  const std::size_t body = datagram.size() - kChannelTrailerBytes;
  if (load_little_endian<std::uint32_t>(&datagram[body]) != crc32c(datagram.first(body)))
    return {Verdict::bad_checksum};
  const std::span<const std::byte> inside = datagram.subspan(kChannelHeaderBytes, size);
  std::copy(inside.begin(), inside.end(), payload.begin());
  return {Verdict::accepted, size};
}

}  // namespace farhand
