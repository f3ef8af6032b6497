// Messages to and from payload bytes (a type byte and proto/wire.proto), in fixed buffers. Both
// directions apply one rule (common/message_rules.hpp), so nothing leaves that the other side would
// refuse. Since all fields are required and of fixed width, the size alone refuses whatever is
// repeated, unknown or appended.
#pragma once

#include <cstddef>
#include <memory>
#include <span>

#include "common/message_rules.hpp"
#include "common/wire.hpp"

namespace farhand {

// Holds the parsed objects for reuse: allocates when constructed, not after.
class Codec {
 public:
  Codec();
  ~Codec();
  Codec(const Codec&) = delete;
  Codec& operator=(const Codec&) = delete;

  // The bytes written to `payload` (kMaxPayloadBytes or more); 0 if the message is not valid.
  std::size_t encode(const Hello& hello, std::span<std::byte> payload) noexcept;
  std::size_t encode(const Header& header, const MasterToSlave& message,
                     std::span<std::byte> payload) noexcept;
  std::size_t encode(const Header& header, const SlaveToMaster& message,
                     std::span<std::byte> payload) noexcept;

  // accepted, malformed, or unexpected_type if the payload is of another type; for a hello also
  // wrong_version, which leaves only protocol_version filled. Outputs count only if accepted.
  Verdict decode(std::span<const std::byte> payload, Hello& hello) noexcept;
  Verdict decode(std::span<const std::byte> payload, Header& header,
                 MasterToSlave& message) noexcept;
  Verdict decode(std::span<const std::byte> payload, Header& header,
                 SlaveToMaster& message) noexcept;

 private:
  struct Messages;
  std::unique_ptr<Messages> messages_;
};

}  // namespace farhand
