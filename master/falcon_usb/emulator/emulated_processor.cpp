#include "master/falcon_usb/emulator/emulated_processor.hpp"

#include <string_view>
#include <utility>

#include "master/falcon_usb/ftdi.hpp"

namespace farhand::falcon_usb {
namespace {

constexpr std::string_view kGreeting = "\x0a\x43\x0d", kGreetingAnswer = "\x0a\x44\x2c\x0d";
constexpr std::byte kHurry{'A'};
constexpr std::size_t kMostGarbage = 20;

}  // namespace

EmulatedProcessor::EmulatedProcessor(const ProcessorConfig& config, Mechanism mechanism,
                                     std::uint64_t seed)
    : config_(config), mechanism_(std::move(mechanism)), random_(seed) {
  power_on();
  if (config.firmware_loaded) load_firmware();
  if (config.homed) homed_ = kAllHomed;
}

void EmulatedProcessor::power_on() noexcept {
  powered_ = true;
  state_ = State::dead;
  finder_.reset();
  homed_ = 0;
  seen_ = false;
}

void EmulatedProcessor::start_boot_loader() noexcept {
  if (powered_) state_ = State::greeting;
  matched_ = 0;
}

void EmulatedProcessor::hear(std::byte b, TimePoint at, std::uint16_t divisor, Duration byte_time,
                             SerialLine& out) noexcept {
  switch (state_) {
    case State::greeting:
      return greet(b, at, divisor, byte_time, out);
    case State::download:
      if (divisor == kBaudUpload.value) load(b, at, byte_time, out);
      return;
    case State::running:
      if (divisor != kBaudPackets.value) return;
      if (const Packet* packet = finder_.take(b))
        if (const auto command = decode_command(*packet)) answer(*command, at, byte_time, out);
      return;
    case State::dead:
      return;
  }
}

void EmulatedProcessor::greet(std::byte b, TimePoint at, std::uint16_t divisor, Duration byte_time,
                              SerialLine& out) noexcept {
  if (divisor == kBaudUpload.value && b == kHurry) {
    state_ = State::download;
    loaded_ = 0;
    out.push(b, at, byte_time);
  }
  if (divisor != kBaudBoot.value) return;
  const auto is = [&](std::size_t i) { return b == static_cast<std::byte>(kGreeting[i]); };
  matched_ = is(matched_) ? matched_ + 1 : is(0) ? 1 : 0;
  if (matched_ < kGreeting.size()) return;
  matched_ = 0;
  if (config_.zero_before_greeting) out.push(std::byte{0}, at, byte_time);
  for (const char c : kGreetingAnswer) out.push(static_cast<std::byte>(c), at, byte_time);
}

void EmulatedProcessor::load(std::byte b, TimePoint at, Duration byte_time,
                             SerialLine& out) noexcept {
  if (chance(config_.faults.echo_wrong)) b ^= static_cast<std::byte>(1 + random_.bits() % 255);
  out.push(b, at, byte_time);
  if (++loaded_ == config_.firmware_bytes) state_ = State::running;
}

Answer EmulatedProcessor::sense(TimePoint at) noexcept {
  const GripState grip = mechanism_.read(at);
  if (!seen_) zero_ = last_ = grip.counts;
  seen_ = true;
  if (!command_.homing) homed_ = 0;
  Answer out{.buttons = grip.buttons};
  for (std::size_t i = 0; i < last_.size(); ++i) {
    const bool passed = (last_[i] < config_.index[i]) != (grip.counts[i] < config_.index[i]);
    if (passed && command_.homing) homed_ |= static_cast<std::uint8_t>(1u << i);
    const bool homed = (homed_ >> i & 1) != 0;
    out.encoders[i] = static_cast<std::int16_t>(grip.counts[i] - (homed ? 0 : zero_[i]));
  }
  last_ = grip.counts;
  out.homed = homed_;
  return out;
}

void EmulatedProcessor::answer(const Command& command, TimePoint at, Duration byte_time,
                               SerialLine& out) noexcept {
  command_ = command;
  mechanism_.drive(at, command.motors);
  TimePoint from = at + config_.turnaround;
  const Packet packet = encode(sense(at));
  const SerialFaults& faults = config_.faults;
  // Each is drawn whatever the others are, so that a change of one leaves the rest alone.
  const bool lost = chance(faults.lost), garbage = chance(faults.garbage);
  const bool twice = chance(faults.duplicated), delayed = chance(faults.delayed);
  const double share = random_.uniform();
  if (lost) return;
  if (delayed) from += from_seconds(share * seconds(faults.delay));
  if (garbage)
    for (std::uint64_t n = 1 + random_.bits() % kMostGarbage; n > 0; --n)
      out.push(static_cast<std::byte>(random_.bits()), from, byte_time);
  say(packet, from, byte_time, out);
  if (twice) say(packet, from, byte_time, out);
}

void EmulatedProcessor::say(Packet packet, TimePoint from, Duration byte_time,
                            SerialLine& out) noexcept {
  const bool cut = chance(config_.faults.cut), altered = chance(config_.faults.altered);
  const std::size_t place = random_.bits() % kPacketBytes;
  const std::size_t letter = 1 + place % 12;
  if (altered) packet[letter] = static_cast<std::byte>('A' + random_.bits() % 16);
  for (std::size_t i = 0; i < packet.size(); ++i)
    if (!cut || i != place) out.push(packet[i], from, byte_time);
}

}  // namespace farhand::falcon_usb
