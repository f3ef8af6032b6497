// A client and a server of DTLS, and between them a network that the fuzzer moves: what it does to
// each datagram, and what it says itself. Once it leaves them alone they must connect. OpenSSL's
// random numbers differ in every run, so an input alone need not repeat a finding.
#include <deque>

#include "tests/fuzz/input.hpp"
#include "tests/support/dtls_ends.hpp"

namespace farhand {
namespace {

// By the first byte of an input.
const SideCredentials& sides(unsigned first) {
  static const std::array both{test_credentials(Proof::key, 1),
                               test_credentials(Proof::certificates, 1)};
  return both[first % both.size()];
}

struct End {
  End(DtlsRole role, const Credentials& credentials) : handshake(role, credentials) {}

  void collect(std::deque<Bytes>& to) {
    for (Bytes& d : all_outgoing(handshake)) to.push_back(std::move(d));
    if (auto made = handshake.take_session()) session = std::move(made);
  }

  DtlsHandshake handshake;
  std::unique_ptr<DtlsSession> session;
  std::deque<Bytes> coming;
};

enum Harm { pass, drop, twice, flip, cut, swap, splice, foreign, wait, kHarms };

class Network {
 public:
  explicit Network(const SideCredentials& sides)
      : client_(DtlsRole::client, sides.client), server_(DtlsRole::server, sides.server) {
    client_.handshake.start(kServerAddress, now_);
    collect();
  }

  void move(Input& input) {
    const unsigned what = input.byte();
    End& to = (what & 1) != 0 ? client_ : server_;
    if (const auto harm = static_cast<Harm>(what / 2 % kHarms); harm == wait) {
      step(std::chrono::milliseconds(input.number() % 8192));
    } else if (harm == foreign) {
      const auto said = input.take(input.number() % (2 * kMaxDatagramBytes));
      deliver(to, said, (what & 128) != 0 ? test_address(9) : other(to));
    } else if (!to.coming.empty()) {
      Bytes d = std::move(to.coming.front());
      to.coming.pop_front();
      damage(d, harm, to, input);
    }
  }

  bool connect() {
    for (int i = 0; i < 12000 && !(client_.session && server_.session); ++i) {
      for (End* end : {&client_, &server_})
        for (; !end->coming.empty(); end->coming.pop_front())
          deliver(*end, end->coming.front(), other(*end));
      step(std::chrono::milliseconds(1));
    }
    return client_.session && server_.session;
  }

 private:
  static constexpr std::size_t kKept = 16;

  void damage(Bytes& d, Harm harm, End& to, Input& input) {
    if (harm == drop) return;
    if (harm == swap) return to.coming.push_back(std::move(d));
    if (harm == flip) d[input.number() % d.size()] ^= static_cast<std::byte>(input.byte());
    if (harm == cut) d.resize(input.number() % d.size());
    if (harm == splice && !to.coming.empty()) {
      const Bytes& tail = to.coming.front();
      d.resize(input.number() % d.size());
      d.insert(d.end(), tail.begin(), tail.end());
    }
    deliver(to, d, other(to));
    if (harm == twice) deliver(to, d, other(to));
  }

  const UdpAddress& other(const End& of) const {
    return &of == &client_ ? kServerAddress : kClientAddress;
  }
  void deliver(End& to, std::span<const std::byte> datagram, const UdpAddress& from) {
    to.handshake.receive(datagram, from, now_);
    collect();
  }
  void step(Duration by) {
    now_ += by;
    client_.handshake.tick(now_);
    server_.handshake.tick(now_);
    collect();
  }
  void collect() {
    client_.collect(server_.coming);
    server_.collect(client_.coming);
    for (End* end : {&client_, &server_})
      while (end->coming.size() > kKept) end->coming.pop_front();
  }

  TimePoint now_{std::chrono::hours(1)};
  End client_, server_;
};

// Moves of a handshake that nobody disturbs, then a flight said by the fuzzer itself.
std::string valid_moves(std::uint64_t seed) {
  const auto record = [](unsigned first) {
    DtlsEnds ends(sides(first));
    ends.run(std::chrono::seconds(1));
    return std::array{ends.client_sent, ends.server_sent};
  };
  static const std::array recorded{record(0), record(1)};
  Random random(seed);
  const auto first = static_cast<unsigned>(random.bits() % recorded.size());
  std::string moves(random.bits() % 12, 0);
  for (char& m : moves) m = static_cast<char>(random.bits() % 2);
  moves.insert(moves.begin(), static_cast<char>(first));
  const bool to_client = random.bits() % 2 == 0;
  const auto& said = recorded[first][to_client ? 1 : 0];
  const Bytes& flight = said[random.bits() % said.size()];
  moves += static_cast<char>(2 * foreign + (to_client ? 1 : 0));
  moves += {static_cast<char>(flight.size()), static_cast<char>(flight.size() >> 8)};
  return moves.append(reinterpret_cast<const char*>(flight.data()), flight.size());
}

}  // namespace
}  // namespace farhand

std::size_t LLVMFuzzerCustomMutator(std::uint8_t* data, std::size_t size, std::size_t room,
                                    unsigned seed) {
  using namespace farhand;
  return mutate_or_restart(data, size, room, seed % 8 == 0,
                           seed % 8 == 0 || size == 0 ? valid_moves(seed) : "");
}

int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  using namespace farhand;
  Input input(data, size);
  Network network(sides(input.byte()));
  while (!input.empty()) network.move(input);
  require(network.connect());
  return 0;
}
