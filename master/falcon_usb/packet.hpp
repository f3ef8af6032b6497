// The 16 bytes a Falcon and its host exchange, one packet each way per exchange:
//
//   '<'  four letters per axis 1, 2, 3  flags  spare  '>'
//
// A letter is 'A' plus a nibble; four make an int16 in two's complement, least significant nibble
// first. To the device the words are motor counts, from it encoder counts. Axes are numbered from
// the top clockwise, seen from the front: the legs of FalconGeometry. Neither bracket is a letter,
// so a packet's begin is never found inside another's words.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <optional>
#include <span>

namespace farhand::falcon_usb {

inline constexpr std::size_t kPacketBytes = 16;
using Packet = std::array<std::byte, kPacketBytes>;
using AxisWords = std::array<std::int16_t, 3>;

// Bits of what may be lit, of buttons that are down, and of axes that have passed their index.
enum Led : std::uint8_t { kLedGreen = 2, kLedBlue = 4, kLedRed = 8 };
enum GripButton : std::uint8_t {
  kButtonPlus = 1,  // right
  kButtonForward = 2,
  kButtonCentre = 4,
  kButtonMinus = 8  // left
};
inline constexpr std::uint8_t kAllHomed = 7;

struct Command {
  AxisWords motors{};
  bool homing = true;     // in every packet: one without it makes the device forget its homing
  std::uint8_t leds = 0;  // of Led
  bool operator==(const Command&) const = default;
};

struct Answer {
  AxisWords encoders{};
  std::uint8_t buttons = 0;  // of GripButton
  std::uint8_t homed = 0;    // bit i: axis i
  bool operator==(const Answer&) const = default;
};

Packet encode(const Command& command) noexcept;
Packet encode(const Answer& answer) noexcept;

// The packet's content, or nothing if a bracket, a letter or the flags are not what they can be.
// The spare byte may be anything: nobody knows what a device puts there.
std::optional<Command> decode_command(std::span<const std::byte, kPacketBytes> packet) noexcept;
std::optional<Answer> decode_answer(std::span<const std::byte, kPacketBytes> packet) noexcept;

// Finds packets in a stream that is cut anywhere, with anything in between. A byte that cannot
// belong to a packet is skipped; a packet cut short costs itself, never the one behind it.
class PacketFinder {
 public:
  // The packet that ends with this byte, if one does; valid until the next call.
  const Packet* take(std::byte next) noexcept;
  void reset() noexcept { size_ = 0; }
  std::uint64_t skipped() const noexcept { return skipped_; }  // bytes that were no packet's

 private:
  Packet held_{};
  std::size_t size_ = 0;
  std::uint64_t skipped_ = 0;
};

}  // namespace farhand::falcon_usb
