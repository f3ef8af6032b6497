// The processor of the emulated Falcon: a boot loader that echoes, then firmware that answers
// packets, homes its encoders when the grip passes their index, and drives motors. What it does
// when packets stop is documented nowhere; this one holds the motors' last command.
#pragma once

#include <cstdint>
#include <functional>

#include "common/random.hpp"
#include "master/falcon_usb/emulator/serial_line.hpp"
#include "master/falcon_usb/packet.hpp"

namespace farhand::falcon_usb {

// Chances, each of its own. Of an echoed byte or of an answer.
struct SerialFaults {
  double echo_wrong = 0;
  double lost = 0;
  double duplicated = 0;
  double garbage = 0;  // up to 20 random bytes before it
  double cut = 0;      // one of its bytes is missing
  double altered = 0;  // one of its words' letters is another one: no check can see that
  double delayed = 0;  // by up to `delay`, and all behind it
  Duration delay = std::chrono::milliseconds(4);
};

struct ProcessorConfig {
  std::size_t firmware_bytes = 8492;  // after so many it runs; what they are does not matter
  bool firmware_loaded = false;       // at power-on, as after another program's upload
  bool homed = false;                 // likewise
  bool zero_before_greeting = false;  // as some hosts see it
  Duration turnaround = std::chrono::microseconds(30);
  AxisWords index{};  // true encoder counts of the indices
  SerialFaults faults;
};

// What the mechanism shows: encoders as if homed, GripButton bits.
struct GripState {
  AxisWords counts{};
  std::uint8_t buttons = 0;
};
struct Mechanism {
  std::function<GripState(TimePoint)> read;
  std::function<void(TimePoint, const AxisWords&)> drive;  // motor counts, held until the next
};

class EmulatedProcessor {
 public:
  EmulatedProcessor(const ProcessorConfig& config, Mechanism mechanism, std::uint64_t seed);

  void power_on() noexcept;  // with nothing remembered: no firmware, not homed
  void power_off() noexcept { powered_ = false, state_ = State::dead; }
  void start_boot_loader() noexcept;
  void load_firmware() noexcept {
    if (powered_) state_ = State::running;
  }
  void set_faults(const SerialFaults& faults) noexcept { config_.faults = faults; }
  // A byte heard at `at`, sent at the speed of `divisor`; answers go to `out`.
  void hear(std::byte b, TimePoint at, std::uint16_t divisor, Duration byte_time,
            SerialLine& out) noexcept;

  bool running() const noexcept { return state_ == State::running; }
  bool homed() const noexcept { return homed_ == kAllHomed; }
  const Command& command() const noexcept { return command_; }  // the last one

 private:
  enum class State : std::uint8_t { dead, greeting, download, running };

  void greet(std::byte b, TimePoint at, std::uint16_t divisor, Duration byte_time,
             SerialLine& out) noexcept;
  void load(std::byte b, TimePoint at, Duration byte_time, SerialLine& out) noexcept;
  void answer(const Command& command, TimePoint at, Duration byte_time, SerialLine& out) noexcept;
  Answer sense(TimePoint at) noexcept;
  void say(Packet packet, TimePoint at, Duration byte_time, SerialLine& out) noexcept;
  bool chance(double ratio) noexcept { return random_.uniform() < ratio; }

  ProcessorConfig config_;
  Mechanism mechanism_;
  Random random_;
  bool powered_ = true;
  State state_ = State::dead;
  PacketFinder finder_;
  Command command_;
  std::size_t matched_ = 0;  // of the greeting
  std::size_t loaded_ = 0;
  bool seen_ = false;  // the mechanism, since power-on
  AxisWords zero_{};   // counts at power-on, from which an axis counts until it is homed
  AxisWords last_{};   // counts at the last answer
  std::uint8_t homed_ = 0;
};

}  // namespace farhand::falcon_usb
