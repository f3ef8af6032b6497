#include "common/dtls_connection.hpp"

#include <openssl/bio.h>
#include <openssl/crypto.h>
#include <openssl/hmac.h>
#include <openssl/rand.h>

#include <algorithm>
#include <cstring>
#include <limits>
#include <stdexcept>

namespace farhand {
namespace {

constexpr const char* kCipher = "ECDHE-PSK-CHACHA20-POLY1305";
constexpr const char* kGroup = "X25519";
// Short, so that the answer that carries it is shorter than any hello.
constexpr std::size_t kCookieBytes = 16;

DtlsConnection& connection(BIO* bio) noexcept {
  return *static_cast<DtlsConnection*>(BIO_get_data(bio));
}
DtlsConnection& connection(const SSL* ssl) noexcept {
  return *static_cast<DtlsConnection*>(SSL_get_app_data(ssl));
}
DtlsContext& context(const SSL* ssl) noexcept {
  return *static_cast<DtlsContext*>(SSL_CTX_get_app_data(SSL_get_SSL_CTX(ssl)));
}

int read_datagram(BIO* bio, char* to, int room) noexcept {
  DtlsConnection& c = connection(bio);
  BIO_clear_retry_flags(bio);
  if (c.in.empty()) {
    BIO_set_retry_read(bio);
    return -1;
  }
  const std::size_t size = std::min(c.in.size(), static_cast<std::size_t>(std::max(room, 0)));
  std::memcpy(to, c.in.data(), size);
  if (!c.peeking) c.in = {};
  return static_cast<int>(size);
}

int write_datagram(BIO* bio, const char* from, int size) noexcept {
  DtlsConnection& c = connection(bio);
  BIO_clear_retry_flags(bio);
  const auto bytes = static_cast<std::size_t>(size);
  if (size <= 0 || bytes > kMaxDatagramBytes || c.written == c.out.size()) return size;
  std::memcpy(c.out[c.written].bytes.data(), from, bytes);
  c.out[c.written++].size = bytes;
  return size;
}

long control(BIO* bio, int command, long number, void*) noexcept {
  if (command == BIO_CTRL_FLUSH) return 1;
  if (command == BIO_CTRL_DGRAM_SET_PEEK_MODE) {
    connection(bio).peeking = number != 0;
    return 1;
  }
  return 0;
}

BIO_METHOD* datagrams() {
  static const std::unique_ptr<BIO_METHOD, Freed<BIO_meth_free>> kMethod = [] {
    std::unique_ptr<BIO_METHOD, Freed<BIO_meth_free>> m(
        BIO_meth_new(BIO_get_new_index() | BIO_TYPE_SOURCE_SINK, "datagrams in memory"));
    BIO_meth_set_read(m.get(), read_datagram);
    BIO_meth_set_write(m.get(), write_datagram);
    BIO_meth_set_ctrl(m.get(), control);
    return m;
  }();
  return kMethod.get();
}

unsigned give_secret(const SSL* ssl, unsigned char* to, unsigned room) noexcept {
  const Key& key = context(ssl).key;
  if (room < key.secret.size()) return 0;
  std::memcpy(to, key.secret.data(), key.secret.size());
  return static_cast<unsigned>(key.secret.size());
}

unsigned client_key(SSL* ssl, const char*, char* name, unsigned name_room, unsigned char* to,
                    unsigned room) noexcept {
  const std::string& own = context(ssl).key.name;
  if (own.size() >= name_room) return 0;
  std::memcpy(name, own.c_str(), own.size() + 1);
  return give_secret(ssl, to, room);
}

unsigned server_key(SSL* ssl, const char* name, unsigned char* to, unsigned room) noexcept {
  DtlsContext& own = context(ssl);
  if (name != nullptr && name == own.key.name) return give_secret(ssl, to, room);
  ++own.counters.other_key;
  return 0;
}

// Field by field: an address has padding.
bool cookie(const SSL* ssl, std::uint64_t window, unsigned char* to) noexcept {
  const UdpAddress& peer = connection(ssl).peer;
  std::array<unsigned char, 16 + 4 + 2 + 1 + 8> text{};
  std::memcpy(text.data(), peer.bytes.data(), 16);
  std::memcpy(&text[16], &peer.scope, 4);
  std::memcpy(&text[20], &peer.port, 2);
  text[22] = peer.v6 ? 1 : 0;
  std::memcpy(&text[23], &window, 8);
  std::array<unsigned char, EVP_MAX_MD_SIZE> digest{};
  const auto& secret = context(ssl).cookie_secret;
  if (HMAC(EVP_sha256(), secret.data(), static_cast<int>(secret.size()), text.data(), text.size(),
           digest.data(), nullptr) == nullptr)
    return false;
  std::memcpy(to, digest.data(), kCookieBytes);
  return true;
}

int make_cookie(SSL* ssl, unsigned char* to, unsigned* size) noexcept {
  *size = kCookieBytes;
  return cookie(ssl, connection(ssl).cookie_window, to) ? 1 : 0;
}

// Of this window or the one before, so that none is too old the moment it is made.
int check_cookie(SSL* ssl, const unsigned char* got, unsigned size) noexcept {
  std::array<unsigned char, kCookieBytes> own{};
  for (const std::uint64_t back : {0, 1})
    if (size == own.size() && cookie(ssl, connection(ssl).cookie_window - back, own.data()) &&
        CRYPTO_memcmp(own.data(), got, own.size()) == 0)
      return 1;
  return 0;
}

// Longer than any handshake: OpenSSL's timer reads the wall clock, so it must never ring.
unsigned never(SSL*, unsigned) noexcept {
  return std::numeric_limits<unsigned>::max();
}

[[noreturn]] void refuse() {
  throw std::runtime_error(std::string("OpenSSL has no ") + kCipher + " over " + kGroup +
                           " for DTLS 1.2: install an unrestricted libssl3");
}

}  // namespace

DtlsContext::DtlsContext(DtlsRole role, const Key& own_key)
    : key(own_key),
      ssl(SSL_CTX_new(role == DtlsRole::client ? DTLS_client_method() : DTLS_server_method())) {
  SSL_CTX* c = ssl.get();
  if (c == nullptr || SSL_CTX_set_min_proto_version(c, DTLS1_2_VERSION) != 1 ||
      SSL_CTX_set_max_proto_version(c, DTLS1_2_VERSION) != 1 ||
      SSL_CTX_set_cipher_list(c, kCipher) != 1 || SSL_CTX_set1_groups_list(c, kGroup) != 1 ||
      RAND_bytes(cookie_secret.data(), static_cast<int>(cookie_secret.size())) != 1)
    refuse();
  SSL_CTX_set_app_data(c, this);
  SSL_CTX_set_options(c, SSL_OP_COOKIE_EXCHANGE | SSL_OP_NO_QUERY_MTU | SSL_OP_NO_RENEGOTIATION |
                             SSL_OP_NO_TICKET | SSL_OP_NO_COMPRESSION);
  SSL_CTX_set_session_cache_mode(c, SSL_SESS_CACHE_OFF);
  SSL_CTX_set_cookie_generate_cb(c, make_cookie);
  SSL_CTX_set_cookie_verify_cb(c, check_cookie);
  if (role == DtlsRole::client)
    SSL_CTX_set_psk_client_callback(c, client_key);
  else
    SSL_CTX_set_psk_server_callback(c, server_key);
}

DtlsConnection::DtlsConnection(DtlsContext& of) : ssl(SSL_new(of.ssl.get())) {
  BIO* bio = BIO_new(datagrams());
  if (ssl == nullptr || bio == nullptr) throw std::bad_alloc();
  BIO_set_data(bio, this);
  BIO_set_init(bio, 1);
  SSL_set_bio(ssl.get(), bio, bio);
  SSL_set_app_data(ssl.get(), this);
  SSL_set_mtu(ssl.get(), static_cast<long>(kMaxDatagramBytes));
  DTLS_set_timer_cb(ssl.get(), never);
  if (SSL_is_server(ssl.get()) != 0)
    SSL_set_accept_state(ssl.get());
  else
    SSL_set_connect_state(ssl.get());
}

}  // namespace farhand
