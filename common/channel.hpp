// The one seam between the bytes of a message and the datagram that carries them, where encryption
// comes in: nothing else knows the frame. The plain channel finds accidents, not attackers:
//
//   0  magic, 4 bytes   |  4  payload length n, 2   |  6  payload, n   |  6 + n  CRC-32C, 4
//
// The checksum covers every byte before it; numbers are little endian.
#pragma once

#include <cstddef>
#include <span>

#include "common/wire.hpp"

namespace farhand {

// Writes the datagram and returns its size; 0 if the payload is empty, above kMaxPayloadBytes, or
// does not fit.
std::size_t seal(std::span<const std::byte> payload, std::span<std::byte> datagram) noexcept;

// The payload is written to `payload`, kMaxPayloadBytes or more, only if the verdict is accepted.
struct Opened {
  Verdict verdict = Verdict::too_short;
  std::size_t size = 0;
};
Opened open(std::span<const std::byte> datagram, std::span<std::byte> payload) noexcept;

}  // namespace farhand
