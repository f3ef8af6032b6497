// What the link's security costs: a message sealed and opened, and a handshake of both sides, with
// a key, with certificates, and beside them the plain frame.
#include <chrono>
#include <cstdio>
#include <memory>

#include "common/channel.hpp"
#include "common/dtls.hpp"
#include "tests/bench/bench_table.hpp"
#include "tests/support/dtls_ends.hpp"

namespace farhand::bench {
namespace {

constexpr std::size_t kMessageBytes = 200;

// One client and one server that connect again and again, with nothing between them.
class Pair {
 public:
  explicit Pair(Proof proof) : Pair(test_credentials(proof, 1)) {}

  // Bytes of both ways.
  std::size_t connect() {
    bytes_ = 0;
    client_.start(kServerAddress, now_);
    while (deliver(client_, server_, kClientAddress) | deliver(server_, client_, kServerAddress)) {
    }
    client_session = client_.take_session();
    server_session = server_.take_session();
    return client_session && server_session ? bytes_ : 0;
  }
  // Of one datagram taken in, in the handshake with the median of them, in ns.
  double usual_longest_step() {
    std::vector<double> all(201);
    for (double& ns : all) {
      longest_ = 0;
      connect();
      ns = longest_;
    }
    std::nth_element(all.begin(), all.begin() + 100, all.end());
    return all[100];
  }

  std::unique_ptr<DtlsSession> client_session, server_session;

 private:
  explicit Pair(const SideCredentials& sides)
      : client_(DtlsRole::client, sides.client), server_(DtlsRole::server, sides.server) {}

  bool deliver(DtlsHandshake& from, DtlsHandshake& to, const UdpAddress& address) {
    const auto said = all_outgoing(from);
    for (const Bytes& d : said) {
      const auto begin = std::chrono::steady_clock::now();
      to.receive(d, address, now_);
      const Duration took = std::chrono::steady_clock::now() - begin;
      longest_ = std::max(longest_, static_cast<double>(took.count()));
      bytes_ += d.size();
    }
    return !said.empty();
  }

  TimePoint now_{std::chrono::hours(1)};
  DtlsHandshake client_, server_;
  std::size_t bytes_ = 0;
  double longest_ = 0;
};

// A message as it goes from one end to the other.
struct Passage {
  std::shared_ptr<Pair> pair;  // none: the plain frame
  Bytes payload = some_payload(1, kMessageBytes);
  Bytes datagram = Bytes(kMaxDatagramBytes), opened = Bytes(kMaxPayloadBytes);

  std::size_t operator()(std::size_t) {
    if (!pair) return open(std::span(datagram).first(seal(payload, datagram)), opened).size;
    const std::size_t size = pair->client_session->seal(payload, datagram);
    return pair->server_session->open(std::span(datagram).first(size), opened).size;
  }
};

void contend(Table& table, const char* contender, Proof proof) {
  const auto pair = std::make_shared<Pair>(proof);
  const std::size_t bytes = pair->connect();
  char note[80];
  std::snprintf(note, sizeof note, "%zu bytes, longest step %.0f us", bytes,
                1e-3 * pair->usual_longest_step());
  table.time({{{"link, sealed and opened", contender, "200 bytes"}}}, 1, Passage{pair});
  const auto another = std::make_shared<Pair>(proof);
  table.time({{{"link, handshake", contender, "both sides"}, {.note = note}}}, 1,
             [another](std::size_t) { return another->connect(); });
}

}  // namespace
}  // namespace farhand::bench

int main(int argc, char** argv) {
  using namespace farhand;
  bench::Table table(argc, argv);
  bench::contend(table, bench::kOurs, Proof::key);
  bench::contend(table, "Farhand, certificates", Proof::certificates);
  table.time({{{"link, sealed and opened", "plain frame", "200 bytes"}}}, 1, bench::Passage{});
  return table.finish();
}
