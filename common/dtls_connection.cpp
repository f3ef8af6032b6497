#include "common/dtls_connection.hpp"

#include <openssl/bio.h>

#include <algorithm>
#include <cstring>
#include <limits>
#include <new>

namespace farhand {
namespace {

DtlsConnection& end_of(BIO* bio) noexcept {
  return *static_cast<DtlsConnection*>(BIO_get_data(bio));
}

int read_datagram(BIO* bio, char* to, int room) noexcept {
  DtlsConnection& c = end_of(bio);
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
  DtlsConnection& c = end_of(bio);
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
    end_of(bio).peeking = number != 0;
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

// Longer than any handshake: OpenSSL's timer reads the wall clock, so it must never ring.
unsigned never(SSL*, unsigned) noexcept {
  return std::numeric_limits<unsigned>::max();
}

}  // namespace

DtlsConnection& connection(const SSL* ssl) noexcept {
  return *static_cast<DtlsConnection*>(SSL_get_app_data(ssl));
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
