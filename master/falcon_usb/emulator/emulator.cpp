#include "master/falcon_usb/emulator/emulator.hpp"

#include <algorithm>
#include <utility>

#include "master/falcon_usb/ftdi.hpp"

namespace farhand::falcon_usb {
namespace {

constexpr Duration kDefaultLatency = std::chrono::milliseconds(16);
// What the chip says of itself when all is well: clear to send and data set ready; sender empty.
constexpr std::array kStatus{std::byte{0x31}, std::byte{0x60}};

}  // namespace

Emulator::Emulator(const EmulatorConfig& config, Mechanism mechanism)
    : config_(config),
      processor_(config.processor, std::move(mechanism), config.seed),
      packets_random_(config.seed + 1),
      requests_random_(config.seed + 2) {}

void Emulator::plug(TimePoint now, bool power_kept, Refusal refusal) noexcept {
  if (!power_kept) processor_.power_on();
  reset_chip(now);
  on_bus_ = refusal == Refusal::none;
  const EventKind kind = on_bus_ ? EventKind::attached : EventKind::refused;
  bus_event_ = Event{.kind = kind, .refusal = refusal};
  bus_event_at_ = now + config_.transfer_time;
}

// The bus feeds it: it remembers nothing.
void Emulator::reset_chip(TimePoint now) noexcept {
  request_.reset();
  arriving_.reset();
  to_processor_.clear();
  from_processor_.clear();
  divisor_ = 0;
  dtr_ = false;
  latency_ = kDefaultLatency;
  timer_ = now + latency_;
}

void Emulator::unplug(TimePoint now) noexcept {
  on_bus_ = false;
  reset_chip(now);
  bus_event_ = Event{.kind = EventKind::detached};
  bus_event_at_ = now;
}

void Emulator::submit(const Request& request, TimePoint now) noexcept {
  if (!on_bus_) return;
  const BusFaults& faults = config_.faults;
  const bool fails = requests_random_.uniform() < faults.failed;
  const bool hangs = requests_random_.uniform() < faults.hung && strikes(request);
  request_ = request;
  request_fails_ = hangs || (fails && strikes(request));
  request_end_ = now + (hangs ? faults.hang_time : config_.transfer_time);
}

bool Emulator::strikes(const Request& request) const noexcept {
  const RequestKind struck = config_.faults.struck;
  return struck == RequestKind::any || (struck == RequestKind::control) == request.is_control;
}

Duration Emulator::byte_time() const noexcept {
  constexpr Duration kAt3MHz{
      3333};  // ten bits; a divisor's upper bits are eighths, too few to count
  return (divisor_ & 0x3fff) * kAt3MHz;
}

TimePoint Emulator::hand_over_at() const noexcept {
  if (!on_bus_ || arriving_) return TimePoint::max();
  return std::min(timer_, from_processor_.time_of(kFtdiPayloadBytes - 1));
}

TimePoint Emulator::due() const noexcept {
  TimePoint at = std::min(hand_over_at(), to_processor_.time_of(0));
  if (request_) at = std::min(at, request_end_);
  if (bus_event_) at = std::min(at, bus_event_at_);
  if (arriving_) at = std::min(at, arriving_at_);
  return at;
}

const Event* Emulator::next_event(TimePoint now) noexcept {
  while (due() <= now)
    if (step(due())) return &event_;
  return nullptr;
}

// Does what is due first. True if the host is told of it.
bool Emulator::step(TimePoint at) noexcept {
  if (bus_event_ && bus_event_at_ <= at) {
    event_ = *std::exchange(bus_event_, std::nullopt);
    return true;
  }
  if (to_processor_.time_of(0) <= at) {
    processor_.hear(to_processor_.pop(), at, divisor_, byte_time(), from_processor_);
    return false;
  }
  if (arriving_ && arriving_at_ <= at) {
    event_ = *std::exchange(arriving_, std::nullopt);
    return true;
  }
  if (request_ && request_end_ <= at) {
    event_ = {.kind = request_fails_ ? EventKind::failed : EventKind::sent};
    finish_request(at);
    return true;
  }
  hand_over(at);
  return false;
}

void Emulator::finish_request(TimePoint at) noexcept {
  const Request request = *std::exchange(request_, std::nullopt);
  if (request_fails_) return;
  if (request.is_control) return apply(request.control, at);
  for (const std::byte b : request.data.view()) to_processor_.push(b, at, byte_time());
}

void Emulator::apply(const Control& control, TimePoint at) noexcept {
  if (control == kPurgeReceived)
    while (from_processor_.time_of(0) <= at) from_processor_.pop();
  if (control == kPurgeSent) to_processor_.clear();
  if (control.request == kBaudBoot.request) divisor_ = control.value;
  if (control == kDtrLow) dtr_ = false;
  if (control == kDtrHigh && !std::exchange(dtr_, true)) processor_.start_boot_loader();
  if (control.request == kLatencyBoot.request) {
    latency_ = std::chrono::milliseconds(control.value);
    timer_ = std::min(timer_, at + latency_);
  }
}

void Emulator::hand_over(TimePoint at) noexcept {
  const std::size_t there = std::min(from_processor_.through(at), kFtdiPayloadBytes);
  const bool held = packets_random_.uniform() < config_.faults.held;
  const bool split = packets_random_.uniform() < config_.faults.split;
  const std::size_t part = packets_random_.bits() % (there + 1);
  arriving_ = Event{.kind = EventKind::received};
  UsbBytes& packet = arriving_->packet;
  std::copy(kStatus.begin(), kStatus.end(), packet.bytes.begin());
  packet.size = kFtdiStatusBytes;
  for (std::size_t n = held ? 0 : split ? part : there; n > 0; --n)
    packet.bytes[packet.size++] = from_processor_.pop();
  arriving_at_ = at + config_.transfer_time;
  timer_ = at + latency_;
}

}  // namespace farhand::falcon_usb
