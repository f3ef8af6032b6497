// What the slave tells the master, to bytes and back: the product's protobuf of doubles against
// plain copies of doubles, floats and fixed-point numbers. The plain ones check nothing.
#include <cstring>
#include <memory>
#include <random>

#include "common/channel.hpp"
#include "common/codec.hpp"
#include "tests/bench/bench_table.hpp"

namespace farhand::bench {
namespace {

struct Message {
  Header header;
  SlaveToMaster body;
};

std::vector<Message> messages(std::size_t n) {
  std::mt19937_64 generator(1701);
  const auto draw = [&](double size) {
    return std::uniform_real_distribution<double>(-size, size)(generator);
  };
  const auto vector = [&](double size) { return Vec3(draw(size), draw(size), draw(size)); };
  std::vector<Message> out(n);
  std::uint64_t sequence = 0;
  for (Message& m : out) {
    m.header = {generator(), generator(),       ++sequence, sequence * 1000003,
                sequence,    sequence * 999983, 12345};
    m.body = {.p_SE = vector(0.6),
              .q_SE = Quat(draw(1), draw(1), draw(1), draw(1)).normalized(),
              .V_SE = {vector(3), vector(1)},
              .F_E_M = {vector(30), vector(2)},
              .mode = Mode::engaged,
              .coupled = true,
              .limits = static_cast<std::uint32_t>(generator() & 7),
              .dead_man_presses_seen = 1,
              .energies = {draw(10), draw(10)}};
  }
  return out;
}

// The product: encode and decode, with `frame` also magic, length and checksum.
template <bool frame>
struct Ours {
  struct Buffers {
    Codec codec;
    std::array<std::byte, kMaxPayloadBytes> payload{}, opened{};
    std::array<std::byte, kMaxDatagramBytes> datagram{};
  };
  std::shared_ptr<Buffers> b = std::make_shared<Buffers>();
  std::size_t operator()(const Message& in, Message& out) const {
    std::size_t size = b->codec.encode(in.header, in.body, b->payload);
    std::span<const std::byte> payload(b->payload.data(), size);
    if constexpr (frame) {
      size = seal(payload, b->datagram);
      const Opened opened = open({b->datagram.data(), size}, b->opened);
      payload = {b->opened.data(), opened.size};
    }
    return b->codec.decode(payload, out.header, out.body) == Verdict::accepted ? size : 0;
  }
};

// Numbers of type T one after the other; integers in units of range / largest integer.
template <typename T>
class Plain {
 public:
  std::size_t operator()(const Message& in, Message& out) const {
    std::array<std::byte, 400> bytes;
    std::byte* end = bytes.data();
    write(end, in);
    benchmark::DoNotOptimize(bytes);
    const std::byte* from = bytes.data();
    read(from, out);
    return static_cast<std::size_t>(end - bytes.data());
  }

 private:
  struct Rest {
    Mode mode;
    Reason reason;
    bool coupled;
    std::uint32_t limits, dead_man, clutch;
    PortEnergies energies;
  };
  static constexpr double kPosition = 2, kUnit = 1, kTurn = 32, kSpeed = 8, kForce = 256,
                          kTorque = 32;

  template <typename V>
  static void put(std::byte*& to, const V& v, double range) {
    for (int i = 0; i < static_cast<int>(v.size()); ++i) {
      T x;
      if constexpr (std::is_integral_v<T>)
        x = static_cast<T>(std::lrint(v[i] * (double(std::numeric_limits<T>::max()) / range)));
      else
        x = static_cast<T>(v[i]);
      std::memcpy(to, &x, sizeof x);
      to += sizeof x;
    }
  }
  template <typename V>
  static void get(const std::byte*& from, V& v, double range) {
    for (int i = 0; i < static_cast<int>(v.size()); ++i) {
      T x;
      std::memcpy(&x, from, sizeof x);
      from += sizeof x;
      if constexpr (std::is_integral_v<T>)
        v[i] = x * (range / double(std::numeric_limits<T>::max()));
      else
        v[i] = static_cast<double>(x);
    }
  }
  static void write(std::byte*& to, const Message& m) {
    std::memcpy(to, &m.header, sizeof m.header);
    to += sizeof m.header;
    const SlaveToMaster& b = m.body;
    put(to, b.p_SE, kPosition);
    put(to, b.q_SE.coeffs(), kUnit);
    put(to, b.V_SE.angular, kTurn);
    put(to, b.V_SE.linear, kSpeed);
    put(to, b.F_E_M.force, kForce);
    put(to, b.F_E_M.torque, kTorque);
    const Rest rest{
        b.mode,    b.reason, b.coupled, b.limits, b.dead_man_presses_seen, b.clutch_presses_seen,
        b.energies};
    std::memcpy(to, &rest, sizeof rest);
    to += sizeof rest;
  }
  static void read(const std::byte*& from, Message& m) {
    std::memcpy(&m.header, from, sizeof m.header);
    from += sizeof m.header;
    SlaveToMaster& b = m.body;
    get(from, b.p_SE, kPosition);
    get(from, b.q_SE.coeffs(), kUnit);
    get(from, b.V_SE.angular, kTurn);
    get(from, b.V_SE.linear, kSpeed);
    get(from, b.F_E_M.force, kForce);
    get(from, b.F_E_M.torque, kTorque);
    Rest rest;
    std::memcpy(&rest, from, sizeof rest);
    b.mode = rest.mode, b.reason = rest.reason, b.coupled = rest.coupled, b.limits = rest.limits;
    b.dead_man_presses_seen = rest.dead_man, b.clutch_presses_seen = rest.clutch;
    b.energies = rest.energies;
  }
};

template <typename Wire>
void contend(Table& table, const char* contender, const char* what, const std::vector<Message>& in,
             const Wire& wire) {
  std::vector<double> position, orientation, force;
  std::size_t bytes = 0;
  for (const Message& m : in) {
    Message out;
    bytes = wire(m, out);
    position.push_back((out.body.p_SE - m.body.p_SE).cwiseAbs().maxCoeff());
    orientation.push_back(2 * (out.body.q_SE.coeffs() - m.body.q_SE.coeffs()).norm());
    force.push_back((out.body.F_E_M.force - m.body.F_E_M.force).cwiseAbs().maxCoeff());
  }
  const std::string note = std::to_string(bytes) + " bytes";
  const auto row = [&](const char* subject, std::vector<double> errors, const char* unit) {
    return Row{{subject, contender, "slave to master and back", what},
               accuracy(std::move(errors), unit, note)};
  };
  table.time({row("wire, position", position, "m"), row("wire, orientation", orientation, "rad"),
              row("wire, force", force, "N")},
             in.size(), [=, out = Message{}](std::size_t i) mutable { return wire(in[i], out); });
}

}  // namespace
}  // namespace farhand::bench

int main(int argc, char** argv) {
  using namespace farhand::bench;
  Table table(argc, argv);
  const std::vector<Message> in = messages(1024);
  contend(table, kOurs, "message", in, Ours<false>{});
  contend(table, "Farhand, datagram", "with frame and checksum", in, Ours<true>{});
  contend(table, "plain double", "", in, Plain<double>{});
  contend(table, "plain float", "", in, Plain<float>{});
  contend(table, "fixed point, 32 bit", "", in, Plain<std::int32_t>{});
  contend(table, "fixed point, 16 bit", "", in, Plain<std::int16_t>{});
  return table.finish();
}
