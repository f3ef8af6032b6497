// farhand-flood: a stranger who says what no partner would, evenly and for a while, and counts what
// comes back.
#include <algorithm>
#include <array>
#include <cstdio>
#include <stdexcept>
#include <thread>
#include <vector>

#include "common/arguments.hpp"
#include "common/dtls.hpp"
#include "common/program.hpp"
#include "common/random.hpp"
#include "common/realtime.hpp"
#include "common/udp.hpp"

namespace farhand {
namespace {

using Bytes = std::vector<std::byte>;

void scribble(Bytes& bytes, std::size_t from, Random& random) {
  for (std::size_t i = from; i < bytes.size(); ++i)
    bytes[i] = static_cast<std::byte>(random.bits());
}

Bytes noise(Random& random) {
  Bytes out(1 + random.bits() % 300);
  scribble(out, 0, random);
  return out;
}

// The clear header of a record of data as it should be, its number included; then noise.
Bytes record(Random& random) {
  constexpr std::size_t kBody = 240, kNumberAt = 5;
  Bytes out(13 + kBody);
  scribble(out, kNumberAt, random);
  constexpr std::array<unsigned char, kNumberAt> kHead{23, 0xfe, 0xfd, 0, 1};
  for (std::size_t i = 0; i < kHead.size(); ++i) out[i] = std::byte{kHead[i]};
  out[kNumberAt] = {};
  out[11] = {};
  out[12] = std::byte{kBody};
  return out;
}

// The first flight of a client, another one each time.
Bytes hello(Random& random) {
  static const Bytes first = [] {
    DtlsHandshake client(DtlsRole::client, make_key({}));
    client.start({}, TimePoint{});
    const auto said = client.outgoing()->datagram();
    return Bytes(said.begin(), said.end());
  }();
  constexpr std::size_t kRandomAt = 27;
  Bytes out = first;
  for (std::size_t i = kRandomAt; i < kRandomAt + 32; ++i)
    out[i] = static_cast<std::byte>(random.bits());
  return out;
}

using Kind = Bytes (*)(Random&);
Bytes any(Random& random) {
  constexpr std::array<Kind, 3> kKinds{noise, record, hello};
  return kKinds[random.bits() % kKinds.size()](random);
}

struct Options {
  std::string to, kind = "any";
  std::optional<std::uint64_t> rate, seed;
  double seconds = 30;
};

Kind kind_of(const std::string& name) {
  if (name == "noise") return noise;
  if (name == "record") return record;
  if (name == "hello") return hello;
  if (name == "any") return any;
  throw std::invalid_argument("--kind is noise, record, hello or any, not '" + name + "'");
}

struct Total {
  std::uint64_t datagrams = 0, bytes = 0, data = 0;  // data: records of it
  void add(std::span<const std::byte> d) {
    ++datagrams;
    bytes += d.size();
    data += d[0] == std::byte{23} ? 1 : 0;
  }
};

void hear(UdpSocket& socket, Total& total) {
  std::array<std::byte, UdpSocket::kReceiveBytes> buffer;
  while (const auto got = socket.receive(buffer))
    if (got->size > 0) total.add(std::span(buffer).first(got->size));
}

int flood(const Options& options) {
  constexpr Duration kStep = std::chrono::milliseconds(1);
  const Kind make = kind_of(options.kind);
  Random random(options.seed.value_or(1));
  std::vector<Bytes> stock;  // made before, so that sending is all that it does
  for (int i = 0; i < 4096; ++i) stock.push_back(make(random));
  UdpSocket socket(parse_udp_address("127.0.0.1:0"), parse_udp_address(options.to));
  const double each = static_cast<double>(options.rate.value_or(20000)) * seconds(kStep);
  enter_realtime({}, kLoopPriority / 2);  // below the loops, above the rest: what is asked is said
  Total said, heard;
  double due = 0;
  const TimePoint begin = monotonic_now(), end = begin + from_seconds(options.seconds);
  // Evenly: what the machine kept it from saying is not made up.
  for (TimePoint at = begin; at < end && !stop_requested();
       at = std::max(at + kStep, monotonic_now())) {
    sleep_until(at);
    for (due += each; due >= 1; due -= 1) {
      const Bytes& next = stock[said.datagrams % stock.size()];
      said.add(next);
      socket.send(next);
    }
    hear(socket, heard);
  }
  std::printf(
      "said %llu datagrams of %s in %.1f s, %llu bytes; heard %llu, %llu bytes, data %llu\n",
      static_cast<unsigned long long>(said.datagrams), options.kind.c_str(),
      seconds(monotonic_now() - begin), static_cast<unsigned long long>(said.bytes),
      static_cast<unsigned long long>(heard.datagrams),
      static_cast<unsigned long long>(heard.bytes), static_cast<unsigned long long>(heard.data));
  return 0;
}

}  // namespace
}  // namespace farhand

int main(int argc, char** argv) {
  using namespace farhand;
  Arguments arguments("a flood of datagrams that no partner would send, for tests",
                      "farhand-flood");
  Options options;
  arguments.option("--to", options.to, "host:port that is flooded; an own test's only");
  arguments.option("--kind", options.kind, "noise, record, hello, or any of them");
  arguments.option("--rate", options.rate, "datagrams a second, 20000 by default");
  arguments.option("--seed", options.seed, "of what is said");
  arguments.duration(options.seconds, "how long");
  if (const auto status =
          arguments.parse(argc, argv, [&] { return options.to.empty() ? "--to" : ""; }))
    return *status;
  catch_stop_signals();
  return run_guarded("farhand-flood", [&] { return flood(options); });
}
