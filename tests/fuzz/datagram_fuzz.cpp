// Two connected ends of the plain link hear whatever the fuzzer says: raw datagrams, and payloads
// in a good frame, as from a hostile peer. A piece of the input is
//
//   flags: 1 the master hears it, else the slave; 2 as it is, else framed; 4 a second of silence
//   size, 2 bytes   |   bytes
#include "common/channel.hpp"
#include "common/link.hpp"
#include "tests/fuzz/input.hpp"
#include "tests/support/messages.hpp"

namespace farhand {
namespace {

constexpr unsigned kToMaster = 1, kRaw = 2, kSilence = 4;

struct Ends {
  Ends() {
    slave.receive(master.hello_due(now), now);
    master.receive(slave.hello_due(now), now);
    for (int i = 0; i < 2; ++i) {
      randomise(random, out), randomise(random, back);
      slave.receive(master.encode(out, now), now);
      master.receive(slave.encode(back, now), now);
    }
  }

  Random random{7};
  TimePoint now{std::chrono::hours(1)};
  MasterLink master{{.session = 1, .scene_hash = 3}};
  SlaveLink slave{{.session = 2, .scene_hash = 3}};
  MasterToSlave out;
  SlaveToMaster back;
};

// Whatever came, what the link holds is valid, its counters add up, and it goes on talking to who
// is there.
template <typename L, typename Message>
void hear(L& link, std::span<const std::byte> datagram, const Message& answer, TimePoint now) {
  link.receive(datagram, now);
  if (link.newest() != nullptr) require(valid(link.newest()->message));
  require(link.counters().received == link.counters().accepted() + link.counters().dropped());
  require(link.peer().has_value());
  const bool said = !link.encode(answer, now).empty();
  require(said || !link.fresh(now, LinkConfig{}.silence));
}

// One datagram of the conversation, as a piece of an input.
std::string valid_piece(std::uint64_t seed) {
  Ends ends;
  Random random(seed);
  const unsigned flags = random.bits() % 8;
  for (std::uint64_t skipped = random.bits() % 4; skipped > 0; --skipped)
    ends.master.encode(ends.out, ends.now), ends.slave.encode(ends.back, ends.now);
  randomise(random, ends.out), randomise(random, ends.back);
  if (random.bits() % 4 == 0) ends.now += std::chrono::seconds(1);
  const auto hello =
      (flags & kToMaster) != 0 ? ends.slave.hello_due(ends.now) : ends.master.hello_due(ends.now);
  const auto data = (flags & kToMaster) != 0 ? ends.slave.encode(ends.back, ends.now)
                                             : ends.master.encode(ends.out, ends.now);
  auto said = hello.empty() ? data : hello;
  if ((flags & kRaw) == 0)
    said =
        said.subspan(kChannelHeaderBytes, said.size() - kChannelHeaderBytes - kChannelTrailerBytes);
  std::string piece{static_cast<char>(flags), static_cast<char>(said.size()),
                    static_cast<char>(said.size() >> 8)};
  return piece.append(reinterpret_cast<const char*>(said.data()), said.size());
}

}  // namespace
}  // namespace farhand

std::size_t LLVMFuzzerCustomMutator(std::uint8_t* data, std::size_t size, std::size_t room,
                                    unsigned seed) {
  using namespace farhand;
  std::string valid;
  if (seed % 8 == 0 || size == 0)
    for (unsigned i = 0; i <= seed / 8 % 4; ++i) valid += valid_piece(seed + i);
  return mutate_or_restart(data, size, room, !valid.empty(), valid);
}

int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  using namespace farhand;
  Ends ends;
  std::array<std::byte, kMaxDatagramBytes> frame;
  for (Input input(data, size); !input.empty();) {
    const unsigned flags = input.byte();
    auto datagram = input.take(input.number());
    if ((flags & kRaw) == 0) {
      const auto payload = datagram.first(std::min(datagram.size(), kMaxPayloadBytes));
      datagram = std::span(frame).first(seal(payload, frame));
    }
    ends.now += (flags & kSilence) != 0 ? std::chrono::seconds(1) : std::chrono::milliseconds(1);
    if ((flags & kToMaster) != 0)
      hear(ends.master, datagram, ends.out, ends.now);
    else
      hear(ends.slave, datagram, ends.back, ends.now);
  }
  return 0;
}
