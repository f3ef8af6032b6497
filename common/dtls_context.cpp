#include <openssl/crypto.h>
#include <openssl/err.h>
#include <openssl/hmac.h>
#include <openssl/rand.h>

#include <cstring>
#include <stdexcept>

#include "common/certificate_rules.hpp"
#include "common/dtls_connection.hpp"

namespace farhand {
namespace {

constexpr const char* kKeyCipher = "ECDHE-PSK-CHACHA20-POLY1305";
constexpr const char* kCertificateCipher = "ECDHE-ECDSA-CHACHA20-POLY1305";
// Short, so that the answer that carries it is shorter than any hello.
constexpr std::size_t kCookieBytes = 16;

DtlsContext& context(const SSL* ssl) noexcept {
  return *static_cast<DtlsContext*>(SSL_CTX_get_app_data(SSL_get_SSL_CTX(ssl)));
}

unsigned give_secret(const Key& key, unsigned char* to, unsigned room) noexcept {
  if (room < key.secret.size()) return 0;
  std::memcpy(to, key.secret.data(), key.secret.size());
  return static_cast<unsigned>(key.secret.size());
}

unsigned client_key(SSL* ssl, const char*, char* name, unsigned name_room, unsigned char* to,
                    unsigned room) noexcept {
  const Key& own = *std::get_if<Key>(&context(ssl).credentials);
  if (own.name.size() >= name_room) return 0;
  std::memcpy(name, own.name.c_str(), own.name.size() + 1);
  return give_secret(own, to, room);
}

unsigned server_key(SSL* ssl, const char* name, unsigned char* to, unsigned room) noexcept {
  const Key& own = *std::get_if<Key>(&context(ssl).credentials);
  return name != nullptr && name == own.name ? give_secret(own, to, room) : 0;
}

bool set_key(SSL_CTX* c, DtlsRole role) noexcept {
  if (role == DtlsRole::client)
    SSL_CTX_set_psk_client_callback(c, client_key);
  else
    SSL_CTX_set_psk_server_callback(c, server_key);
  return SSL_CTX_set_cipher_list(c, kKeyCipher) == 1 && SSL_CTX_set1_groups_list(c, "X25519") == 1;
}

// Asked about the other side's certificate when OpenSSL has found no fault with it.
int check_role(int good, X509_STORE_CTX* chain) noexcept {
  const auto* ssl = static_cast<const SSL*>(
      X509_STORE_CTX_get_ex_data(chain, SSL_get_ex_data_X509_STORE_CTX_idx()));
  const auto role = SSL_is_server(ssl) != 0 ? DtlsRole::client : DtlsRole::server;
  if (good != 1 || X509_STORE_CTX_get_error_depth(chain) > 0) return good;
  X509* const other = X509_STORE_CTX_get_current_cert(chain);
  if (names_role(other, role) && (context(ssl).observers || !names_observer(other))) return 1;
  X509_STORE_CTX_set_error(chain, X509_V_ERR_INVALID_PURPOSE);
  return 0;
}

// Keys are agreed upon over X25519, which both name first; P-256 is there for the certificates. The
// authority's is not sent: both have it.
bool set_certificates(SSL_CTX* c, const Certificates& own, DtlsRole role) noexcept {
  SSL_CTX_set_mode(c, SSL_MODE_NO_AUTO_CHAIN);
  SSL_CTX_set_max_cert_list(c, kMaxCertificateBytes + 16);
  SSL_CTX_set_verify(c, SSL_VERIFY_PEER | SSL_VERIFY_FAIL_IF_NO_PEER_CERT, check_role);
  SSL_CTX_set_security_level(c, 2);
  const auto other = role == DtlsRole::client ? DtlsRole::server : DtlsRole::client;
  return SSL_CTX_set_cipher_list(c, kCertificateCipher) == 1 &&
         SSL_CTX_set1_groups_list(c, "X25519:P-256") == 1 &&
         SSL_CTX_set1_sigalgs_list(c, "ECDSA+SHA256") == 1 &&
         SSL_CTX_use_certificate(c, own.own.get()) == 1 &&
         SSL_CTX_use_PrivateKey(c, own.private_key.get()) == 1 &&
         X509_STORE_add_cert(SSL_CTX_get_cert_store(c), own.authority.get()) == 1 &&
         expect_role(SSL_CTX_get0_param(c), other);
}

// Field by field: an address has padding.
bool cookie(const SSL* ssl, std::uint64_t window, unsigned char* to) noexcept {
  const UdpAddress& peer = connection(ssl).peer;
  std::array<unsigned char, 16 + 4 + 2 + 1 + 8 + kDtlsRandomBytes> text{};
  std::memcpy(text.data(), peer.bytes.data(), 16);
  std::memcpy(&text[16], &peer.scope, 4);
  std::memcpy(&text[20], &peer.port, 2);
  text[22] = peer.v6 ? 1 : 0;
  std::memcpy(&text[23], &window, 8);
  std::memcpy(&text[31], connection(ssl).hello_random.data(), kDtlsRandomBytes);
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

[[noreturn]] void refuse_openssl(const char* cipher) {
  throw std::runtime_error(std::string("OpenSSL has no ") + cipher +
                           " over X25519 for DTLS 1.2: install an unrestricted libssl3");
}

}  // namespace

DtlsContext::DtlsContext(DtlsRole role, const Credentials& own, bool observers_too)
    : credentials(own),
      observers(observers_too),
      ssl(SSL_CTX_new(role == DtlsRole::client ? DTLS_client_method() : DTLS_server_method())) {
  SSL_CTX* c = ssl.get();
  const auto* certificates = std::get_if<Certificates>(&own);
  if (c == nullptr || SSL_CTX_set_min_proto_version(c, DTLS1_2_VERSION) != 1 ||
      SSL_CTX_set_max_proto_version(c, DTLS1_2_VERSION) != 1 ||
      !(certificates != nullptr ? set_certificates(c, *certificates, role) : set_key(c, role)) ||
      RAND_bytes(cookie_secret.data(), static_cast<int>(cookie_secret.size())) != 1)
    refuse_openssl(certificates != nullptr ? kCertificateCipher : kKeyCipher);
  SSL_CTX_set_app_data(c, this);
  SSL_CTX_set_options(c, SSL_OP_COOKIE_EXCHANGE | SSL_OP_NO_QUERY_MTU | SSL_OP_NO_RENEGOTIATION |
                             SSL_OP_NO_TICKET | SSL_OP_NO_COMPRESSION);
  SSL_CTX_set_session_cache_mode(c, SSL_SESS_CACHE_OFF);
  SSL_CTX_set_cookie_generate_cb(c, make_cookie);
  SSL_CTX_set_cookie_verify_cb(c, check_cookie);
}

std::optional<Mismatch> seen_mismatch(const SSL* ssl) noexcept {
  const unsigned long error = ERR_peek_error();
  const int reason = ERR_GET_LIB(error) == ERR_LIB_SSL ? ERR_GET_REASON(error) : 0;
  if (reason == SSL_R_NO_SHARED_CIPHER) return Mismatch::other_kind;
  if (reason == SSL_R_PSK_IDENTITY_NOT_FOUND) return Mismatch::other_secret;
  switch (SSL_get_verify_result(ssl)) {
    case X509_V_OK:
      return {};
    case X509_V_ERR_CERT_HAS_EXPIRED:
      return Mismatch::expired;
    case X509_V_ERR_CERT_NOT_YET_VALID:
      return Mismatch::not_yet_valid;
    case X509_V_ERR_INVALID_PURPOSE:
      return Mismatch::wrong_role;
    default:
      return Mismatch::other_secret;
  }
}

std::optional<Mismatch> said_mismatch(std::byte alert) noexcept {
  switch (std::to_integer<int>(alert)) {
    case SSL_AD_UNKNOWN_PSK_IDENTITY:
    case SSL_AD_UNKNOWN_CA:
    case SSL_AD_DECRYPT_ERROR:
      return Mismatch::other_secret;
    case SSL_AD_HANDSHAKE_FAILURE:
      return Mismatch::other_kind;
    case SSL_AD_CERTIFICATE_EXPIRED:
      return Mismatch::expired;
    case SSL_AD_BAD_CERTIFICATE:
      return Mismatch::not_yet_valid;
    case SSL_AD_UNSUPPORTED_CERTIFICATE:
      return Mismatch::wrong_role;
    default:
      return {};
  }
}

}  // namespace farhand
