// A UDP socket that never blocks and never throws once it is open. Bytes only: what they mean, and
// whom to believe, is the link's affair.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <memory>
#include <optional>
#include <span>
#include <string>
#include <utility>

#include "common/time.hpp"
#include "common/wire.hpp"

namespace farhand {

// An IPv4 address in the first four bytes, or an IPv6 address.
struct UdpAddress {
  std::array<std::uint8_t, 16> bytes{};
  std::uint32_t scope = 0;  // of a link-local IPv6 address
  std::uint16_t port = 0;
  bool v6 = false;

  bool operator==(const UdpAddress&) const = default;
};

// "10.0.0.2:5555", "[fe80::1%eth0]:5555"; a number, not a name. Throws a sentence with the remedy.
UdpAddress parse_udp_address(const std::string& text);
std::string to_string(const UdpAddress& address);

struct UdpCounters {
  std::uint64_t sent = 0;
  std::uint64_t send_would_block = 0;  // dropped: the socket's buffer was full
  std::uint64_t send_failed = 0;       // dropped: no route, no peer, forbidden, ...
  std::uint64_t received = 0;
  std::uint64_t receive_failed = 0;
  std::uint64_t refused = 0;  // the peer's host said that nobody listens there (ICMP)
};

class UdpSocket {
 public:
  // One byte more than a datagram may have, so that one too long shows.
  static constexpr std::size_t kReceiveBytes = kMaxDatagramBytes + 1;

  struct Received {
    std::size_t size = 0;
    UdpAddress from;
  };

  // Binds to `local` (port 0: any free one). With a fixed peer the kernel drops what others send;
  // without one, tell set_peer who sent the last datagram that was accepted. Throws a sentence
  // naming the address and the remedy. If this host gets another address, a socket bound to all of
  // them (0.0.0.0) sends on from that, possibly from another port.
  explicit UdpSocket(const UdpAddress& local, const std::optional<UdpAddress>& fixed_peer = {});
  ~UdpSocket();
  UdpSocket(UdpSocket&&) noexcept;
  UdpSocket& operator=(UdpSocket&&) noexcept;

  UdpAddress local() const noexcept;
  const std::optional<UdpAddress>& peer() const noexcept;
  void set_peer(const UdpAddress& peer) noexcept;  // without effect on a fixed peer

  // To the peer, at once or not at all: false and counted if there is none, the buffer is full, or
  // the system refuses. An empty datagram is not sent.
  bool send(std::span<const std::byte> datagram) noexcept;

  // The same to another address, without effect on the peer; to the peer if it is fixed.
  bool send_to(std::span<const std::byte> datagram, const UdpAddress& to) noexcept;

  // The oldest datagram waiting, or nothing. Longer ones are cut to the buffer's size.
  std::optional<Received> receive(std::span<std::byte> buffer) noexcept;

  // Sleeps until something can be received (true) or CLOCK_MONOTONIC reaches `deadline` (false). A
  // refusal by the peer's host also wakes it; receive then gives nothing.
  bool wait_readable(TimePoint deadline) noexcept;

  // The same without sleeping: asks again and again, and keeps the processor busy.
  bool spin_readable(TimePoint deadline) noexcept;

  // The same with a deadline set ahead, for a loop that answers as soon as something comes: the
  // wait itself then starts and ends no timer. Without one it waits for something to receive.
  void set_deadline(TimePoint deadline) noexcept;
  bool wait_readable() noexcept;

  // The same as the first for either of two.
  static bool wait_readable(UdpSocket& a, UdpSocket& b, TimePoint deadline) noexcept;

  std::size_t receive_buffer() const noexcept;  // bytes, as the kernel counts them; 0: unknown
  const UdpCounters& counters() const noexcept;

 private:
  struct State;
  std::unique_ptr<State> state_;
};

}  // namespace farhand
