// The Falcon's driver hears whatever the fuzzer says. A piece of the input is
//
//   what: 0 to 5 an event kind, 6 and 7 an answer   |   time since the last, in 0.1 ms
//   a packet: size, bytes      an answer: three words, buttons and homed axes
#include "master/falcon_usb/driver.hpp"
#include "tests/fuzz/input.hpp"

namespace farhand::falcon_usb {
namespace {

struct Bench {
  const std::array<std::byte, 70> image{};
  Driver driver{{.firmware = image}};
  TimePoint now{std::chrono::hours(1)};
  bool busy = false;

  // Whatever it asks for, it asks for one thing at a time, and for torque only when armed.
  void look(Input& input) {
    Vec6 tau;
    for (double& x : tau) x = input.byte() - 128.0;
    driver.write(now, tau);
    require(driver.read(now).theta.allFinite());
    const auto request = driver.next(now);
    require(!request || !busy);
    busy = busy || request.has_value();
    if (!request || request->is_control || request->data.size != kPacketBytes) return;
    const auto command =
        decode_command(std::span<const std::byte, kPacketBytes>(request->data.bytes.data(), 16));
    if (!command) return;  // a piece of firmware
    const bool armed = driver.status().phase == Phase::armed;
    for (const int counts : command->motors) require(std::abs(counts) <= (armed ? kMostCounts : 0));
  }
};

Event event(Input& input, unsigned what) {
  Event out{.kind = static_cast<EventKind>(std::min(what, 5u))};
  if (what == static_cast<unsigned>(EventKind::refused)) out.refusal = Refusal::busy;
  if (what == static_cast<unsigned>(EventKind::received)) {
    const auto bytes = input.take(input.byte() % (kUsbPacketBytes + 1));
    std::copy(bytes.begin(), bytes.end(), out.packet.bytes.begin());
    out.packet.size = bytes.size();
  }
  if (what < 6) return out;
  Answer answer;
  for (std::int16_t& word : answer.encoders) word = static_cast<std::int16_t>(input.number());
  const unsigned flags = input.byte();
  answer.buttons = static_cast<std::uint8_t>(flags & 15);
  answer.homed = static_cast<std::uint8_t>(flags >> 4 & 7);
  const Packet packet = encode(answer);
  std::copy(packet.begin(), packet.end(), out.packet.bytes.begin() + 2);
  out.packet.size = packet.size() + 2;
  out.kind = EventKind::received;
  return out;
}

}  // namespace
}  // namespace farhand::falcon_usb

int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  using namespace farhand;
  using namespace farhand::falcon_usb;
  Bench bench;
  for (Input input(data, size); !input.empty();) {
    const Event heard = event(input, input.byte() % 8);
    bench.now += std::chrono::microseconds(100) * input.byte();
    bench.busy = bench.busy && heard.kind == EventKind::received;
    bench.driver.hear(heard, bench.now);
    bench.look(input);
  }
  return 0;
}
