// What DTLS is to the programs (common/secure_channel.hpp), without its randomness: a connection of
// two nonces under a shared key, a number and a keyed checksum on every frame, a window against
// replays, and the old connection in use until the new one is confirmed. No secret and no cipher:
// it refuses what a simulated attacker without the key can make, with the same bits each time.
//
//   0  checksum, 8   |  8  kind, 1   |  9  number or nonce, 8   |  17  payload, or second nonce
#pragma once

#include <array>
#include <optional>
#include <span>

#include "common/random.hpp"
#include "common/sequence_window.hpp"
#include "common/time.hpp"
#include "common/wire.hpp"

namespace farhand {

class KeyedChannel {
 public:
  // The master's end asks for connections, the slave's answers. seed: of this process.
  KeyedChannel(Role role, std::uint64_t seed) noexcept : role_(role), random_(seed) {}

  // Empty without a connection. What these return is valid until the next call.
  std::span<const std::byte> seal(std::span<const std::byte> datagram) noexcept;
  std::span<const std::byte> open(std::span<const std::byte> frame, TimePoint now) noexcept;
  // A frame of the handshake that is to be sent, or empty.
  std::span<const std::byte> due(TimePoint now) noexcept;

 private:
  static constexpr std::uint64_t kSharedKey = 0x6661726861'6e64;
  static constexpr Duration kSilence = std::chrono::milliseconds(500);
  static constexpr Duration kAskAgain = std::chrono::milliseconds(100);
  enum Kind : std::uint8_t { kRequest = 1, kReply, kData };
  struct Connection {
    std::uint64_t key = 0, sent = 0;
    SequenceWindow seen{};
  };
  using Frame = std::array<std::byte, kMaxDatagramBytes>;

  std::size_t write(Frame& to, std::uint64_t key, Kind kind, std::uint64_t number,
                    std::span<const std::byte> payload) noexcept;
  void on_request(std::uint64_t nonce) noexcept;
  void on_reply(std::uint64_t nonce, std::uint64_t peers, TimePoint now) noexcept;
  bool belongs(Connection& c, std::span<const std::byte> frame, std::uint64_t number) noexcept;

  Role role_;
  Random random_;
  std::optional<Connection> present_, next_;
  std::uint64_t asked_ = 0;  // our nonce while we wait for the reply
  TimePoint heard_{}, ask_at_{};
  Frame sealed_{}, handshake_{};
  std::size_t reply_ = 0;  // bytes of it that wait in handshake_
};

}  // namespace farhand
