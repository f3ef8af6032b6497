// CRC-32C (Castagnoli; RFC 3720 appendix B.4): finds every change of up to 5 bits, every odd number
// of bits and every burst of up to 32 bits in a datagram of up to 655 bytes (Koopman 2002).
#pragma once

#include <cstddef>
#include <cstdint>
#include <span>

namespace farhand {

// "123456789" gives 0xe3069283; no bytes give 0.
std::uint32_t crc32c(std::span<const std::byte> bytes) noexcept;

}  // namespace farhand
