#include "master/falcon_usb/packet.hpp"

#include <algorithm>

namespace farhand::falcon_usb {
namespace {

constexpr unsigned kBegin = '<', kEnd = '>', kZero = 'A';
constexpr std::size_t kWordBytes = 4, kFlags = 13, kSpare = 14;
constexpr unsigned kMostFlags = 0x7f;  // four buttons, three axes

constexpr std::byte letter(unsigned value) noexcept {
  return static_cast<std::byte>(kZero + value);
}

Packet encode(const AxisWords& words, unsigned flags) noexcept {
  Packet out;
  out.front() = static_cast<std::byte>(kBegin);
  for (std::size_t i = 0; i < words.size() * kWordBytes; ++i) {
    const auto word = static_cast<std::uint16_t>(words[i / kWordBytes]);
    out[1 + i] = letter(word >> (4 * (i % kWordBytes)) & 0xf);
  }
  out[kFlags] = letter(flags);
  out[kSpare] = letter(0);
  out.back() = static_cast<std::byte>(kEnd);
  return out;
}

// Whether a packet can have this byte at this place.
bool fits(std::size_t place, std::byte b) noexcept {
  const unsigned value = std::to_integer<unsigned>(b);
  if (place == 0) return value == kBegin;
  if (place == kSpare) return true;
  if (place == kPacketBytes - 1) return value == kEnd;
  return value >= kZero && value - kZero <= (place == kFlags ? kMostFlags : 0xf);
}

bool is_packet(std::span<const std::byte> bytes) noexcept {
  for (std::size_t i = 0; i < bytes.size(); ++i)
    if (!fits(i, bytes[i])) return false;
  return true;
}

AxisWords words(std::span<const std::byte, kPacketBytes> packet) noexcept {
  AxisWords out{};
  for (std::size_t axis = 0; axis < out.size(); ++axis) {
    unsigned word = 0;
    for (std::size_t k = 0; k < kWordBytes; ++k)
      word |= (std::to_integer<unsigned>(packet[1 + axis * kWordBytes + k]) - kZero) << (4 * k);
    out[axis] = static_cast<std::int16_t>(word);
  }
  return out;
}

unsigned flags(std::span<const std::byte, kPacketBytes> packet) noexcept {
  return std::to_integer<unsigned>(packet[kFlags]) - kZero;
}

}  // namespace

Packet encode(const Command& c) noexcept {
  return encode(c.motors, (c.leds & 0xeu) | (c.homing ? 1u : 0u));
}

Packet encode(const Answer& a) noexcept {
  return encode(a.encoders, (a.buttons & 0xfu) | (a.homed & 7u) << 4);
}

std::optional<Command> decode_command(std::span<const std::byte, kPacketBytes> packet) noexcept {
  if (!is_packet(packet) || flags(packet) > 0xf) return {};
  return Command{.motors = words(packet),
                 .homing = (flags(packet) & 1) != 0,
                 .leds = static_cast<std::uint8_t>(flags(packet) & 0xe)};
}

std::optional<Answer> decode_answer(std::span<const std::byte, kPacketBytes> packet) noexcept {
  if (!is_packet(packet)) return {};
  return Answer{.encoders = words(packet),
                .buttons = static_cast<std::uint8_t>(flags(packet) & 0xf),
                .homed = static_cast<std::uint8_t>(flags(packet) >> 4)};
}

const Packet* PacketFinder::take(std::byte next) noexcept {
  if (size_ == kPacketBytes) size_ = 0;
  held_[size_++] = next;
  if (!fits(size_ - 1, next)) {
    // What is held begins no packet; a later byte of it may.
    do {
      std::copy(held_.begin() + 1, held_.begin() + size_, held_.begin());
      --size_;
      ++skipped_;
    } while (!is_packet(std::span(held_).first(size_)));
  }
  return size_ == kPacketBytes ? &held_ : nullptr;
}

}  // namespace farhand::falcon_usb
