// The channel of common/channel.hpp with DTLS in place of a checksum: the same two functions over
// buffers. It has two halves. The loop's seals, opens and sorts out what belongs to a handshake; it
// neither allocates nor waits. The other makes connections, on another thread or, in a test, on the
// same one. Between them are bounded queues.
//
// A client's connection stays in use until a new one is authenticated, then ends for good. A
// server's also stays when another client, or the same anew, has connected: that connection stands
// beside it, is heard and answered, and takes its place only when the link accepts what comes
// through it. So either side may restart, nobody without credentials can end a connection, and of
// those with them only the one that the link lets lead. The newest beside is the only one.
#pragma once

#include <atomic>
#include <memory>
#include <optional>

#include "common/dtls.hpp"
#include "common/spsc_queue.hpp"

namespace farhand {

struct SecureChannelConfig {
  // The address a client connects to; nothing: a server.
  std::optional<UdpAddress> server;
  // A client that has opened nothing for so long makes a new connection beside the present one.
  Duration silence = std::chrono::milliseconds(500);
  DtlsConfig dtls;
};

class SecureChannel {
 public:
  // Throws as DtlsHandshake does.
  SecureChannel(const SecureChannelConfig& config, const Credentials& credentials);
  ~SecureChannel();
  SecureChannel(const SecureChannel&) = delete;
  SecureChannel& operator=(const SecureChannel&) = delete;

  // The loop's half. As DtlsSession; 0 and not_connected before a connection stands.
  std::size_t seal(std::span<const std::byte> payload, std::span<std::byte> datagram) noexcept;
  Opened open(std::span<const std::byte> datagram, std::span<std::byte> payload) noexcept;
  // The link accepted the last payload opened: the connection it came through is in use from now
  // on.
  void settle() noexcept;
  // Seals through the connection that the last payload opened came through.
  std::size_t seal_answer(std::span<const std::byte> payload,
                          std::span<std::byte> datagram) noexcept;
  // True for the datagram of a handshake, which needs no opening; dropped if too many wait.
  bool take(std::span<const std::byte> datagram, const UdpAddress& from) noexcept;
  // The next datagram of a handshake to send, or nullptr; valid until the next call.
  const DtlsOutgoing* outgoing() noexcept;

  // The other half: whatever is to be done at `now`; to be called every few milliseconds.
  void service(TimePoint now);
  const DtlsCounters& counters() const noexcept { return handshake_.counters(); }
  const std::string& peer_certificate() const noexcept { return handshake_.peer_certificate(); }

 private:
  void adopt() noexcept;
  void pass_on();
  void publish() noexcept;
  void keep_connected(TimePoint now);

  static constexpr std::size_t kQueue = 16;
  SecureChannelConfig config_;
  SpscQueue<DtlsOutgoing> in_{kQueue}, out_{kQueue};  // of `in_`, `to` is where it came from
  bool sending_ = false;                              // the front of out_ is being sent
  std::atomic<DtlsSession*> made_{nullptr};           // for the loop; it empties this one last
  std::atomic<DtlsSession*> retired_{nullptr};        // from the loop
  std::atomic<std::uint64_t> opened_{0};

  std::unique_ptr<DtlsSession> session_;  // the loop's
  std::unique_ptr<DtlsSession> beside_;   // a server's newest that is not in use, or one that was
  bool beside_open_ = false;              // it may still come into use
  bool came_beside_ = false;              // the last payload opened came through it

  DtlsHandshake handshake_;
  std::unique_ptr<DtlsSession> next_;
  std::uint64_t opened_before_ = 0;
  std::optional<TimePoint> heard_;
};

// Sends what a handshake has to say. Nothing without a channel.
void send_handshake(SecureChannel* channel, UdpSocket& socket) noexcept;

}  // namespace farhand
