#include <openssl/err.h>

#include <algorithm>
#include <utility>

#include "common/dtls_connection.hpp"

namespace farhand {
namespace {

// As long as a client repeats its hello, and no longer: a hello with its cookie can be played back.
constexpr Duration kCookieWindow = std::chrono::seconds(5);

// In a ClientHello or ServerHello that is the first record of its datagram, as those of DTLS are:
// after the headers of record (13) and message (12) and the version (2), the random number.
constexpr std::size_t kMessageAt = kDtlsHeaderBytes, kRandomAt = kMessageAt + 14;

// Of what is part_of_handshake: its first message, in clear.
bool begins_with(int message, std::span<const std::byte> datagram) noexcept {
  return datagram[0] == std::byte{SSL3_RT_HANDSHAKE} && datagram[4] == std::byte{0} &&
         std::to_integer<int>(datagram[kMessageAt]) == message;
}

bool has_random(std::span<const std::byte> datagram) noexcept {
  return datagram.size() >= kRandomAt + kDtlsRandomBytes;
}

bool client_hello(std::span<const std::byte> datagram) noexcept {
  return has_random(datagram) && begins_with(SSL3_MT_CLIENT_HELLO, datagram);
}

// Of what is part_of_handshake, or nothing of nothing.
std::span<const std::byte> first_record(std::span<const std::byte> datagram) noexcept {
  if (datagram.empty()) return {};
  const std::size_t length =
      std::to_integer<std::size_t>(datagram[11]) << 8 | std::to_integer<std::size_t>(datagram[12]);
  return datagram.first(kDtlsHeaderBytes + length);
}

bool alert(std::span<const std::byte> datagram) noexcept {
  return datagram[0] == std::byte{SSL3_RT_ALERT};
}

void count(std::optional<Mismatch> m, std::array<std::uint64_t, kMismatches>& to) noexcept {
  if (m) ++to[static_cast<std::size_t>(*m)];
}

std::uint64_t cookie_window(TimePoint now) noexcept {
  return static_cast<std::uint64_t>(now.time_since_epoch() / kCookieWindow);
}

}  // namespace

DtlsHandshake::DtlsHandshake(DtlsRole role, const Credentials& credentials,
                             const DtlsConfig& config)
    : config_(config),
      context_(std::make_unique<DtlsContext>(role, credentials, config.observers)) {
  if (role == DtlsRole::server) listener_ = std::make_unique<DtlsConnection>(*context_);
}

DtlsHandshake::~DtlsHandshake() = default;

const DtlsCounters& DtlsHandshake::counters() const noexcept {
  return context_->counters;
}

void DtlsHandshake::start(const UdpAddress& to, TimePoint now) {
  if (server_) return;
  server_ = to;
  begin(now);
}

void DtlsHandshake::begin(TimePoint now) {
  pending_ = std::make_unique<DtlsConnection>(*context_);
  peer_ = *server_;
  since_ = now;
  verified_ = answered_ = false;
  ++context_->counters.begun;
  step({}, now);
}

// The server sends the flight of an attempt before until it hears of this one, and OpenSSL would
// take it for an answer: with a key nothing shows that it is none. It is known by its random
// number, which came before this attempt's cookie or was taken in the last one.
bool DtlsHandshake::of_an_attempt_before(std::span<const std::byte> datagram) noexcept {
  verified_ = verified_ || begins_with(DTLS1_MT_HELLO_VERIFY_REQUEST, datagram);
  if (!has_random(datagram) || !begins_with(SSL3_MT_SERVER_HELLO, datagram)) return false;
  const auto random = datagram.subspan(kRandomAt, kDtlsRandomBytes);
  const bool known = std::equal(random.begin(), random.end(), hello_.begin());
  if (known) return !answered_;
  std::copy(random.begin(), random.end(), hello_.begin());
  answered_ = verified_;
  return !answered_;
}

void DtlsHandshake::receive(std::span<const std::byte> datagram, const UdpAddress& from,
                            TimePoint now) {
  const bool ours = part_of_handshake(datagram);
  if (ours && listener_ && client_hello(datagram)) return on_hello(datagram, from, now);
  if (ours && from == peer_ && pending_ && alert(datagram)) return on_alert(datagram);
  const bool old = ours && from == peer_ && server_ && of_an_attempt_before(datagram);
  if (ours && from == peer_ && pending_ && !old) return step(datagram, now);
  if (ours && from == peer_ && repeats_last_) return repeat_last(now);
  ++context_->counters.ignored;
}

// Never twice within half the time after which a client asks again: anyone can ask in its name.
void DtlsHandshake::repeat_last(TimePoint now) noexcept {
  if (now - since_ >= config_.limit || now < again_at_) {
    ++context_->counters.ignored;
    return;
  }
  again_at_ = now + config_.resend / 2;
  send_again();
}

void DtlsHandshake::tick(TimePoint now) {
  const bool unheard = server_ && now - flown_ >= config_.patience;
  if (pending_ && (unheard || now - since_ >= config_.limit)) end(context_->counters.expired, now);
  if (now < again_at_) return;
  if (!pending_ && server_) begin(now);
  if (!pending_) return;
  wait_ = std::min(2 * wait_, config_.most_resend);
  again_at_ = now + wait_;
  send_again();
}

// The peer's window against replay drops what it has and takes what it has not.
void DtlsHandshake::send_again() noexcept {
  next_ = 0;
  ++context_->counters.resent;
}

// Where the last authenticated client was: a restarted one comes back from there, by another port.
bool DtlsHandshake::from_client_host(UdpAddress address) const noexcept {
  if (!client_) return false;
  address.port = client_->port;
  return address == *client_;
}

// The copy of a hello whose handshake is known must not begin it again, and others none so soon
// that their flights add up.
bool DtlsHandshake::may_begin(std::span<const std::byte> random, const UdpAddress& from,
                              TimePoint now) const noexcept {
  const bool stands = pending_ || repeats_last_;
  if (stands && from == peer_ && std::equal(random.begin(), random.end(), hello_.begin()))
    return false;
  const Duration hold = pending_ && from != peer_ ? config_.protection : config_.resend;
  const bool free = repeats_last_ || counters().begun == 0 || now - since_ >= hold;
  return free || (from_client_host(from) && !from_client_host(peer_));
}

void DtlsHandshake::on_hello(std::span<const std::byte> datagram, const UdpAddress& from,
                             TimePoint now) {
  const auto random = datagram.subspan(kRandomAt, kDtlsRandomBytes);
  if (!may_begin(random, from, now)) {
    ++context_->counters.ignored;
    return;
  }
  if (!prove(datagram, from, now)) return;
  pending_ = std::move(listener_);
  listener_ = std::make_unique<DtlsConnection>(*context_);
  std::copy(random.begin(), random.end(), hello_.begin());
  peer_ = from;
  since_ = now;
  repeats_last_ = false;
  ++context_->counters.begun;
  step(datagram, now);
}

// True: the hello has our cookie. Otherwise the reply brings it.
bool DtlsHandshake::prove(std::span<const std::byte> datagram, const UdpAddress& from,
                          TimePoint now) {
  DtlsConnection& listener = *listener_;
  listener.in = first_record(datagram);
  listener.peer = from;
  std::copy_n(datagram.begin() + kRandomAt, kDtlsRandomBytes, listener.hello_random.begin());
  listener.cookie_window = cookie_window(now);
  ERR_clear_error();
  std::unique_ptr<BIO_ADDR, Freed<BIO_ADDR_free>> unused(BIO_ADDR_new());
  const bool proven = DTLSv1_listen(listener.ssl.get(), unused.get()) == 1;
  listener.peeking = false;
  listener.in = {};
  if (!proven && listener.written > 0) {
    reply_waits_ = true;
    reply_.to = from;
    reply_.size = listener.out[0].size;
    std::copy_n(listener.out[0].bytes.begin(), reply_.size, reply_.bytes.begin());
  }
  listener.written = 0;
  return proven;
}

// Only a hint for the user: anyone can send one.
void DtlsHandshake::on_alert(std::span<const std::byte> datagram) noexcept {
  count(said_mismatch(datagram.back()), context_->counters.said);
}

// Record by record, so that none is left in OpenSSL to disturb the session.
void DtlsHandshake::step(std::span<const std::byte> datagram, TimePoint now) {
  do {
    const std::span<const std::byte> record = first_record(datagram);
    datagram = datagram.subspan(record.size());
    advance(record, now);
  } while (pending_ && part_of_handshake(datagram) && !alert(datagram));
}

void DtlsHandshake::advance(std::span<const std::byte> record, TimePoint now) {
  DtlsConnection& c = *pending_;
  c.in = record;
  ERR_clear_error();
  const int status = SSL_do_handshake(c.ssl.get());
  const bool waits = status <= 0 && SSL_get_error(c.ssl.get(), status) == SSL_ERROR_WANT_READ;
  c.in = {};
  if (c.written > 0) take_flight(now);
  if (status == 1) {
    ++context_->counters.done;
    const X509* const other = SSL_get0_peer_certificate(c.ssl.get());
    peer_certificate_ = other != nullptr ? fingerprint(*other) : "";
    session_ = std::make_unique<DtlsSession>(std::move(pending_));
    server_.reset();
    repeats_last_ = listener_ != nullptr;
    client_ = peer_;
  } else if (!waits) {
    count(seen_mismatch(c.ssl.get()), context_->counters.seen);
    end(context_->counters.failed, now);
  }
}

void DtlsHandshake::take_flight(TimePoint now) {
  DtlsConnection& c = *pending_;
  for (std::size_t i = 0; i < c.written; ++i) {
    flight_[i].to = peer_;
    flight_[i].size = c.out[i].size;
    std::copy_n(c.out[i].bytes.begin(), c.out[i].size, flight_[i].bytes.begin());
  }
  flight_size_ = c.written;
  c.written = next_ = 0;
  flown_ = now;
  wait_ = config_.resend;
  again_at_ = now + wait_;
}

// A client waits before it begins again, so that nothing a stranger sends makes it hurry.
void DtlsHandshake::end(std::uint64_t& reason, TimePoint now) noexcept {
  ++reason;
  pending_.reset();
  again_at_ = now + config_.most_resend;
}

const DtlsOutgoing* DtlsHandshake::outgoing() noexcept {
  if (std::exchange(reply_waits_, false)) return &reply_;
  return next_ < flight_size_ ? &flight_[next_++] : nullptr;
}

}  // namespace farhand
