// OpenSSL's side of common/dtls.hpp: only dtls_*.cpp include it.
#pragma once

#include <openssl/ssl.h>

#include <array>
#include <cstdint>
#include <memory>
#include <optional>
#include <span>

#include "common/dtls.hpp"
#include "common/openssl_pointers.hpp"

namespace farhand {

// What all connections of one side share.
struct DtlsContext {
  DtlsContext(DtlsRole role, const Credentials& credentials, bool observers);

  Credentials credentials;
  bool observers;  // may connect
  std::array<unsigned char, 32> cookie_secret{};
  DtlsCounters counters;
  std::unique_ptr<SSL_CTX, Freed<SSL_CTX_free>> ssl;
};

// After a handshake that failed: what was not right of the other side, if that shows.
std::optional<Mismatch> seen_mismatch(const SSL* ssl) noexcept;
// What the other side says in an alert is not right of this one.
std::optional<Mismatch> said_mismatch(std::byte alert) noexcept;

// One end with the datagrams it reads and writes. OpenSSL keeps its address.
struct DtlsConnection {
  explicit DtlsConnection(DtlsContext& of);

  struct Datagram {
    std::array<std::byte, kMaxDatagramBytes> bytes{};
    std::size_t size = 0;
  };
  std::span<const std::byte> in;  // to be read; empty: nothing
  bool peeking = false;           // reading leaves it there
  std::array<Datagram, 4> out;    // written; what does not fit is lost, as on any network
  std::size_t written = 0;

  // The cookie is for this address, this hello and this time.
  UdpAddress peer;
  std::array<std::byte, kDtlsRandomBytes> hello_random{};
  std::uint64_t cookie_window = 0;

  std::unique_ptr<SSL, Freed<SSL_free>> ssl;
};

DtlsConnection& connection(const SSL* ssl) noexcept;

}  // namespace farhand
