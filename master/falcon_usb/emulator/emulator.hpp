// A Falcon that is not there: its USB chip and the processor behind it, as one transport under
// virtual time. Same configuration, seed and calls, same bits.
//
// The chip hands bytes over when a packet is full or its latency timer is up, which at 1 ms makes
// the 1 kHz of the packet loop. Not modelled: the bus' own timing beyond a constant per transfer,
// RTS and CTS, and what the real boot loader checks.
#pragma once

#include "master/falcon_usb/emulator/emulated_processor.hpp"
#include "master/falcon_usb/transport.hpp"

namespace farhand::falcon_usb {

enum class RequestKind : std::uint8_t { any, write, control };

struct BusFaults {
  // Chances per packet from the chip.
  double split = 0;  // it carries only some of what is there, the next one the rest
  double held = 0;   // it carries nothing, the next one twice as much
  // Chances per request of the kind struck, which then has no effect.
  double failed = 0;  // it fails
  double hung = 0;    // it fails after hang_time
  Duration hang_time = kDataTime;
  RequestKind struck = RequestKind::any;
};

struct EmulatorConfig {
  ProcessorConfig processor;
  BusFaults faults;
  Duration transfer_time = std::chrono::microseconds(60);  // of a request or a packet on the bus
  std::uint64_t seed = 1;
};

class Emulator {
 public:
  Emulator(const EmulatorConfig& config, Mechanism mechanism);

  // The user's doings. Plugged in it is found one transfer later. Without power kept, firmware and
  // homing are lost.
  void plug(TimePoint now, bool power_kept = true, Refusal refusal = Refusal::none) noexcept;
  void unplug(TimePoint now) noexcept;
  // The motors' supply fails: the chip stays on the bus, the processor is gone.
  void cut_power() noexcept { processor_.power_off(); }
  void restore_power() noexcept { processor_.power_on(); }
  void load_firmware() noexcept { processor_.load_firmware(); }  // as another program would
  // From now on.
  void set_faults(const SerialFaults& serial, const BusFaults& bus) noexcept {
    processor_.set_faults(serial);
    config_.faults = bus;
  }

  void submit(const Request& request, TimePoint now) noexcept;
  const Event* next_event(TimePoint now) noexcept;
  TimePoint due() const noexcept;  // of the next thing to happen by itself

  const EmulatedProcessor& processor() const noexcept { return processor_; }

 private:
  void reset_chip(TimePoint now) noexcept;
  bool step(TimePoint now) noexcept;
  bool strikes(const Request& request) const noexcept;
  void finish_request(TimePoint at) noexcept;
  void apply(const Control& control, TimePoint at) noexcept;
  TimePoint hand_over_at() const noexcept;
  void hand_over(TimePoint at) noexcept;
  Duration byte_time() const noexcept;

  EmulatorConfig config_;
  EmulatedProcessor processor_;
  Random packets_random_, requests_random_;  // apart: faults of one leave the other alone
  bool on_bus_ = false;
  SerialLine to_processor_, from_processor_;
  std::uint16_t divisor_ = 0;
  bool dtr_ = false;
  Duration latency_{};
  TimePoint timer_{};  // the latency timer's end
  std::optional<Request> request_;
  TimePoint request_end_{};
  bool request_fails_ = false;
  std::optional<Event> bus_event_;  // attached, refused or detached, and when
  TimePoint bus_event_at_{};
  std::optional<Event> arriving_;  // a packet on the bus, and when it is through
  TimePoint arriving_at_{};
  Event event_;
};

static_assert(Transport<Emulator>);

}  // namespace farhand::falcon_usb
