// A UDP relay with a bad network inside, between real processes:
//
//   client (master) <-> listen address | to_server, to_client | <-> server (slave)
//
// The client is whoever sent the last datagram to the listen address, so it may restart and change
// its address; the server has a fixed one. Bytes are not looked at.
#pragma once

#include <array>
#include <cstdint>
#include <optional>
#include <string>

#include "common/impairment.hpp"
#include "common/udp.hpp"

namespace farhand {

struct RelayConfig {
  UdpAddress listen, server;
  std::optional<ImpairmentConfig> to_server, to_client;  // nothing: Impairment::kPlainDelay alone
  std::uint64_t seed = 1;                                // to_client takes the next one
};

class Relay {
 public:
  // Throws a sentence naming the address or the impairment's field, and the remedy.
  explicit Relay(const RelayConfig& config);

  UdpAddress local() const noexcept { return client_.local(); }

  // Takes in what has come and sends what is due.
  void forward(TimePoint now) noexcept;
  // Sleeps until something comes or is due, at most until `latest`.
  void wait(TimePoint latest) noexcept;

  const ImpairmentCounters& to_server() const noexcept { return to_server_.counters(); }
  const ImpairmentCounters& to_client() const noexcept { return to_client_.counters(); }
  // Two rows for people: what became of the datagrams of each way.
  std::string summary() const;

 private:
  UdpSocket client_, server_;
  Impairment to_server_, to_client_;
  std::array<std::byte, UdpSocket::kReceiveBytes> buffer_{};
};

}  // namespace farhand
