// A client and a server of DTLS over two seeded networks in virtual time.
#pragma once

#include <algorithm>
#include <array>
#include <memory>
#include <numeric>
#include <optional>
#include <vector>

#include "common/dtls.hpp"
#include "common/impairment.hpp"
#include "common/random.hpp"
#include "tests/support/test_credentials.hpp"

namespace farhand {

using Bytes = std::vector<std::byte>;

inline UdpAddress test_address(std::uint8_t last) {
  return {.bytes = {10, 0, 0, last}, .port = 4000};
}
inline const UdpAddress kClientAddress = test_address(1), kServerAddress = test_address(2);

inline Bytes copy(std::span<const std::byte> bytes) {
  return {bytes.begin(), bytes.end()};
}

// What a handshake wants to send now.
inline std::vector<Bytes> all_outgoing(DtlsHandshake& of) {
  std::vector<Bytes> all;
  while (const DtlsOutgoing* out = of.outgoing()) all.push_back(copy(out->datagram()));
  return all;
}

class DtlsEnds {
 public:
  explicit DtlsEnds(const SideCredentials& sides, const ImpairmentConfig& network = {},
                    std::uint64_t seed = 1)
      : client(DtlsRole::client, sides.client),
        server(DtlsRole::server, sides.server),
        to_server_(network, seed, 64),
        to_client_(network, seed + 1000000, 64) {
    client.start(kServerAddress, now);
    collect();
  }

  // In steps of a millisecond until both have their session (true) or `limit` has passed.
  bool run(Duration limit) {
    for (const TimePoint end = now + limit; now < end && !(client_session && server_session);)
      step();
    return client_session && server_session;
  }

  void step() {
    now += std::chrono::milliseconds(1);
    std::array<std::byte, kMaxDatagramBytes> buffer;
    for (auto d = to_server_.pop(now, buffer); !d.empty(); d = to_server_.pop(now, buffer)) {
      server.receive(d, kClientAddress, now);
      collect();
    }
    for (auto d = to_client_.pop(now, buffer); !d.empty(); d = to_client_.pop(now, buffer)) {
      client.receive(d, kServerAddress, now);
      collect();
    }
    client.tick(now);
    server.tick(now);
    collect();
  }

  void collect() {
    for (const Bytes& d : all_outgoing(client)) {
      to_server_.push(d, now);
      client_sent.push_back(d);
    }
    for (const Bytes& d : all_outgoing(server)) {
      to_client_.push(d, now);
      server_sent.push_back(d);
    }
    if (auto made = client.take_session()) client_session = std::move(made);
    if (auto made = server.take_session()) server_session = std::move(made);
  }

  TimePoint now{std::chrono::hours(1)};
  DtlsHandshake client, server;
  std::unique_ptr<DtlsSession> client_session, server_session;
  std::vector<Bytes> client_sent, server_sent;

 private:
  Impairment to_server_, to_client_;
};

inline Bytes sealed(DtlsSession& by, std::span<const std::byte> payload) {
  Bytes record(kMaxDatagramBytes);
  record.resize(by.seal(payload, record));
  return record;
}

inline Bytes some_payload(std::uint64_t seed, std::size_t size = 200) {
  Random random(seed);
  Bytes payload(size);
  for (std::byte& b : payload) b = static_cast<std::byte>(random.bits());
  return payload;
}

inline std::size_t bytes_in(const std::vector<Bytes>& all) {
  return std::accumulate(all.begin(), all.end(), std::size_t{0},
                         [](std::size_t n, const Bytes& b) { return n + b.size(); });
}

// Whether what `from` seals is opened by `to`.
inline bool passes(DtlsSession& from, DtlsSession& to, std::uint64_t seed) {
  const Bytes payload = some_payload(seed);
  std::array<std::byte, kMaxPayloadBytes> opened;
  const Opened got = to.open(sealed(from, payload), opened);
  return got.verdict == Verdict::accepted && got.size == payload.size() &&
         std::equal(payload.begin(), payload.end(), opened.begin());
}

}  // namespace farhand
