#include "common/relay.hpp"

#include <spdlog/fmt/fmt.h>

#include <algorithm>

namespace farhand {
namespace {

UdpAddress any_port(const UdpAddress& like) {
  return parse_udp_address(like.v6 ? "[::]:0" : "0.0.0.0:0");
}

// At most as many as a socket's buffer holds, so that a flood cannot keep the relay from sending.
constexpr int kBatch = 256;

void send_due(Impairment& network, UdpSocket& to, std::span<std::byte> buffer,
              TimePoint now) noexcept {
  for (auto d = network.pop(now, buffer); !d.empty(); d = network.pop(now, buffer)) to.send(d);
}

std::string row(const char* way, const Impairment& network, const UdpCounters& out) {
  const ImpairmentCounters& c = network.counters();
  return fmt::format(
      "  {:<10} came {}, sent {}, lost {}, blacked out {}, over the cap {}, doubled {}, held back "
      "{}, corrupted {}, no room {}, too long {}, under way {}, refused by the system {}\n",
      way, c.pushed, c.popped, c.lost, c.blacked_out, c.capped, c.duplicated, c.held_back,
      c.corrupted, c.overflowed, c.oversized, network.waiting(),
      out.send_failed + out.send_would_block);
}

}  // namespace

Relay::Relay(const RelayConfig& config)
    : client_(config.listen),
      server_(any_port(config.server), config.server),
      to_server_(config.to_server, config.seed),
      to_client_(config.to_client, config.seed + 1) {}

void Relay::forward(TimePoint now) noexcept {
  for (int i = 0; i < kBatch; ++i) {
    const auto got = client_.receive(buffer_);
    if (!got) break;
    client_.set_peer(got->from);
    to_server_.push(std::span(buffer_).first(got->size), now);
  }
  for (int i = 0; i < kBatch; ++i) {
    const auto got = server_.receive(buffer_);
    if (!got) break;
    to_client_.push(std::span(buffer_).first(got->size), now);
  }
  send_due(to_server_, server_, buffer_, now);
  send_due(to_client_, client_, buffer_, now);
}

void Relay::wait(TimePoint latest) noexcept {
  for (const auto& due : {to_server_.next_due(), to_client_.next_due()})
    if (due) latest = std::min(latest, *due);
  UdpSocket::wait_readable(client_, server_, latest);
}

std::string Relay::summary() const {
  return row("to server", to_server_, server_.counters()) +
         row("to client", to_client_, client_.counters());
}

}  // namespace farhand
