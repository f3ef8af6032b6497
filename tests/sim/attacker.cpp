#include "tests/sim/attacker.hpp"

#include <cmath>

#include "common/channel.hpp"
#include "common/codec.hpp"

namespace farhand {

void Attacker::overhear(Side to, std::span<const std::byte> datagram) {
  // Without a key anybody may say hello as he likes: only data are replayed then.
  const bool hello = datagram.size() == kChannelHeaderBytes + kHelloBytes + kChannelTrailerBytes;
  if (hello && !secure_) return;
  ++heard_;
  const std::uint64_t place = heard_ <= kept_.size() ? heard_ - 1 : random_.bits() % kept_.size();
  if (heard_ > kept_.size() && random_.uniform() > 0.02) return;
  kept_[place] = {to, {datagram.begin(), datagram.end()}};
}

int Attacker::count(double rate) {
  return static_cast<int>(std::floor(rate + random_.uniform()));
}

const Attacker::Capture* Attacker::pick() {
  if (heard_ == 0) return nullptr;
  return &kept_[random_.bits() % std::min<std::uint64_t>(heard_, kept_.size())];
}

void Attacker::replay(Loopback& loop, double rate) {
  for (int n = count(rate); n > 0; --n) {
    const Capture* c = pick();
    if (c == nullptr) return;
    const bool back = random_.uniform() < 0.1;
    loop.inject(back == (c->to == Side::slave) ? Side::master : Side::slave, c->bytes);
  }
}

// Random bytes; a hello, framed as it should be; a genuine datagram cut, extended or with up to
// three bits flipped, which a CRC-32C of so few bytes always finds.
std::vector<std::byte> Attacker::forged() {
  const auto kind = random_.bits() % 4;
  const Capture* c = pick();
  if (kind == 0 || c == nullptr) {
    std::vector<std::byte> bytes(random_.bits() % 400);
    for (std::byte& b : bytes) b = static_cast<std::byte>(random_.bits());
    return bytes;
  }
  if (kind == 1) {
    std::array<std::byte, kMaxPayloadBytes> payload;
    std::vector<std::byte> bytes(kMaxDatagramBytes);
    Codec codec;
    const auto size = codec.encode({.session = random_.bits() | 1, .scene_hash = random_.bits()},
                                   std::span(payload));
    bytes.resize(seal(std::span(payload).first(size), bytes));
    return bytes;
  }
  std::vector<std::byte> bytes = c->bytes;
  if (kind == 2) bytes.resize(random_.bits() % (2 * bytes.size()));
  if (kind == 2 && bytes.size() == c->bytes.size()) bytes.clear();
  for (auto flips = kind == 3 ? 1 + random_.bits() % 3 : 0; flips > 0; --flips) {
    const auto bit = random_.bits() % (8 * c->bytes.size());
    bytes[bit / 8] = c->bytes[bit / 8] ^ static_cast<std::byte>(1 << bit % 8);
  }
  return bytes;
}

namespace {

std::string text_of(std::span<const std::byte> bytes) {
  return {reinterpret_cast<const char*>(bytes.data()), bytes.size()};
}

}  // namespace

void Attacker::forge(Loopback& loop, double rate) {
  for (int n = count(rate); n > 0; --n) {
    const std::vector<std::byte> bytes = forged();
    made_.insert(text_of(bytes));
    loop.inject(random_.uniform() < 0.7 ? Side::slave : Side::master, bytes);
  }
}

bool Attacker::made(std::span<const std::byte> datagram) const {
  return !made_.empty() && made_.contains(text_of(datagram));
}

void SecondMaster::tick(Loopback& loop) {
  const TimePoint now = loop.now();
  const double t = 1e-3 * static_cast<double>(ticks_++);
  const bool pressed = ticks_ % 1000 > 150;
  const MasterToSlave out{.p_MH = Vec3(0.18, 0.05 * std::sin(4 * t), 0.02 * std::sin(7 * t)),
                          .mode = pressed ? Mode::engaged : Mode::ready,
                          .reason = Reason::none,
                          .dead_man = pressed,
                          .dead_man_presses = static_cast<std::uint32_t>(1 + ticks_ / 1000)};
  if (const auto hello = link_.hello_due(now); !hello.empty()) loop.inject(Side::slave, hello);
  if (const auto data = link_.encode(out, now); !data.empty()) loop.inject(Side::slave, data);
}

}  // namespace farhand
