// DTLS 1.2 over OpenSSL without a socket and without a clock: datagrams and times in, datagrams
// out. Two ciphers that differ in the proof alone: ECDHE-PSK-CHACHA20-POLY1305, where both sides
// prove that they have the key, and ECDHE-ECDSA-CHACHA20-POLY1305, where each proves that it has
// the private key to a certificate of the authority (valid now, by the system's clock). Both go
// over X25519: what was recorded stays secret if a key is lost later.
//
// In two parts, because they run in two places: a handshake allocates and computes for about a
// millisecond, beside the loop; the session it makes seals and opens in the loop.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <memory>
#include <optional>
#include <span>
#include <string>

#include "common/channel.hpp"
#include "common/credentials.hpp"
#include "common/time.hpp"
#include "common/udp.hpp"

namespace farhand {

struct DtlsConnection;
struct DtlsContext;

inline constexpr std::size_t kDtlsRandomBytes = 32;  // of a hello

// What the clear header says: accepted for a record of data after a handshake, else why not. It is
// not protected before the session opens the record.
Verdict judge_record(std::span<const std::byte> datagram) noexcept;

// The same for the datagrams of a handshake; no other need go to DtlsHandshake::receive.
bool part_of_handshake(std::span<const std::byte> datagram) noexcept;

// Once on the thread that will seal and open, before its loop: OpenSSL makes an error state for
// each thread at its first use, the only thing it would allocate there.
void prepare_dtls_thread() noexcept;

// One authenticated connection. Nothing that arrives can end it: alerts and renegotiation are
// dropped unread. Neither function allocates, not even on forged input.
class DtlsSession {
 public:
  explicit DtlsSession(std::unique_ptr<DtlsConnection> connection) noexcept;
  ~DtlsSession();

  // As in common/channel.hpp. Each payload is opened once at most, by the other end's session only;
  // one that comes more than 64 records late is refused too.
  std::size_t seal(std::span<const std::byte> payload, std::span<std::byte> datagram) noexcept;
  Opened open(std::span<const std::byte> datagram, std::span<std::byte> payload) noexcept;

 private:
  std::unique_ptr<DtlsConnection> connection_;
};

struct DtlsConfig {
  // A flight without an answer is sent again after so long; doubled each time, up to the second.
  Duration resend = std::chrono::milliseconds(100);
  Duration most_resend = std::chrono::milliseconds(400);
  // A server keeps a handshake against those from other addresses for so long, and for `resend`
  // against those from its own or after it has failed. Only the host of the client authenticated
  // last comes before strangers.
  Duration protection = std::chrono::seconds(1);
  // A client begins anew when a flight has had no answer for so long: by a damaged datagram the
  // server may have ended the handshake, or made other keys, and can say neither.
  Duration patience = std::chrono::seconds(2);
  // No handshake lasts longer.
  Duration limit = std::chrono::seconds(5);
  // A server takes an observer's certificate, too.
  bool observers = false;
};

// Why the two sides cannot connect, as far as a handshake shows it.
enum class Mismatch : std::uint8_t {
  other_secret,   // another key, or a certificate of another authority
  other_kind,     // a key on one side, certificates on the other
  expired,        // a certificate
  not_yet_valid,  // a certificate; said of us, also one that is damaged
  wrong_role,     // a certificate that is not for what its owner does with it
};
inline constexpr std::size_t kMismatches = 5;

struct DtlsCounters {
  std::uint64_t begun = 0;    // a server's: after the cookie only
  std::uint64_t done = 0;     // authenticated
  std::uint64_t failed = 0;   // ended by a datagram that was not right
  std::uint64_t expired = 0;  // ended by patience or limit
  std::uint64_t resent = 0;   // flights sent again
  std::uint64_t ignored = 0;  // datagrams that belong to no handshake under way
  // Of the other side, as seen here; and of this side, as the other says in an alert, which anyone
  // may have sent.
  std::array<std::uint64_t, kMismatches> seen{}, said{};

  std::uint64_t mismatches(Mismatch m) const noexcept {
    return seen[static_cast<std::size_t>(m)] + said[static_cast<std::size_t>(m)];
  }
};

struct DtlsOutgoing {
  UdpAddress to;
  std::array<std::byte, kMaxDatagramBytes> bytes{};
  std::size_t size = 0;

  std::span<const std::byte> datagram() const noexcept { return std::span(bytes).first(size); }
};

// Makes sessions, one handshake at a time and independent of those that exist.
//
// A server keeps nothing of a client before a cookie has shown that the client receives at its
// address, and until then never answers with more bytes than it got. Alerts are not believed: they
// are not protected. Same calls, same times: same datagrams but for the random numbers in them.
class DtlsHandshake {
 public:
  // Throws a sentence if OpenSSL is without the cipher.
  DtlsHandshake(DtlsRole role, const Credentials& credentials, const DtlsConfig& config = {});
  ~DtlsHandshake();

  // Client: begins with the server at `to` and goes on, as often as it takes, until a session is
  // made. Without effect when under way.
  void start(const UdpAddress& to, TimePoint now);

  void receive(std::span<const std::byte> datagram, const UdpAddress& from, TimePoint now);
  // What time alone brings about.
  void tick(TimePoint now);

  // The next datagram to send, or nullptr; valid until the next call of anything here. To be asked
  // until there is none, after each of the calls above.
  const DtlsOutgoing* outgoing() noexcept;
  // The session made last, once; nullptr: none.
  std::unique_ptr<DtlsSession> take_session() noexcept { return std::move(session_); }

  const DtlsCounters& counters() const noexcept;
  // Of the side authenticated last, its certificate's fingerprint; empty: none, or it has a key.
  const std::string& peer_certificate() const noexcept { return peer_certificate_; }

 private:
  void begin(TimePoint now);
  void on_hello(std::span<const std::byte> datagram, const UdpAddress& from, TimePoint now);
  bool of_an_attempt_before(std::span<const std::byte> datagram) noexcept;
  bool may_begin(std::span<const std::byte> random, const UdpAddress& from,
                 TimePoint now) const noexcept;
  bool prove(std::span<const std::byte> datagram, const UdpAddress& from, TimePoint now);
  bool from_client_host(UdpAddress address) const noexcept;
  void on_alert(std::span<const std::byte> datagram) noexcept;
  void step(std::span<const std::byte> datagram, TimePoint now);
  void advance(std::span<const std::byte> record, TimePoint now);
  void take_flight(TimePoint now);
  void send_again() noexcept;
  void repeat_last(TimePoint now) noexcept;
  void end(std::uint64_t& reason, TimePoint now) noexcept;

  DtlsConfig config_;
  std::unique_ptr<DtlsContext> context_;
  std::unique_ptr<DtlsConnection> listener_;  // server: without state, reads hellos
  std::unique_ptr<DtlsConnection> pending_;
  UdpAddress peer_;  // of pending_, or of the one before
  std::array<std::byte, kDtlsRandomBytes>
      hello_{};                       // its random number, of the other side: tells attempts apart
  bool verified_ = false;             // client: the cookie of this attempt has come,
  bool answered_ = false;             // and the hello_ is its answer
  TimePoint since_{};                 // its begin
  std::optional<UdpAddress> server_;  // client: wanted
  std::optional<UdpAddress> client_;  // server: authenticated last
  // Server: the last flight of a handshake that is done, sent again for each of the client's.
  bool repeats_last_ = false;

  std::array<DtlsOutgoing, 4> flight_;  // our last one
  std::size_t flight_size_ = 0, next_ = 0;
  TimePoint flown_{};  // first sent
  Duration wait_{};
  TimePoint again_at_{};
  DtlsOutgoing reply_;  // to a hello without a cookie
  bool reply_waits_ = false;

  std::unique_ptr<DtlsSession> session_;
  std::string peer_certificate_;
};

}  // namespace farhand
