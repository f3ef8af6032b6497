// Brings firmware into the Falcon's processor, which forgets it without power. The image is the
// user's. Its boot loader answers a greeting at 9600 baud, an 'A' at 142 857 baud, and then echoes
// every byte; there is no checksum, so one wrong echo begins all again.
//
// next() is asked for a request whenever none is on its way, hear() gets what came in.
#pragma once

#include <cstddef>
#include <cstdint>
#include <optional>
#include <span>

#include "master/falcon_usb/ftdi.hpp"

namespace farhand::falcon_usb {

enum class UploadFault : std::uint8_t {
  none,
  no_image,      // an empty one
  no_greeting,   // the boot loader does not answer at 9600 baud
  no_fast_mode,  // nor at 142 857
  echo_missing,
  echo_wrong,
};
const char* to_string(UploadFault fault) noexcept;

struct UploadConfig {
  int attempts = 8;                                      // > 0
  Duration attempt_time = std::chrono::seconds(3);       // of each, at most; 8 kB take 0.7 s
  Duration answer_time = std::chrono::milliseconds(50);  // greeting again, echo given up
};

class FirmwareUpload {
 public:
  FirmwareUpload() = default;
  // The image is borrowed.
  FirmwareUpload(const UploadConfig& config, std::span<const std::byte> image,
                 TimePoint now) noexcept;

  std::optional<Request> next(TimePoint now) noexcept;
  void hear(std::span<const std::byte> bytes, TimePoint now) noexcept;
  // When next() wants to be called even if nothing is heard.
  TimePoint due() const noexcept;

  bool succeeded() const noexcept { return step_ == Step::done; }
  bool failed() const noexcept { return step_ == Step::failed; }
  UploadFault fault() const noexcept { return fault_; }  // of the last attempt that failed
  int attempt() const noexcept { return attempt_; }      // from 1
  double progress() const noexcept;                      // of this attempt, 0 to 1

 private:
  enum class Step : std::uint8_t { greet, hurry, stream, done, failed };

  void begin(TimePoint now) noexcept;
  void give_up(UploadFault fault, TimePoint now) noexcept;
  void hear(std::byte b, TimePoint now) noexcept;
  void enter(Step step, TimePoint now) noexcept;
  std::optional<Request> ask(std::span<const std::byte> bytes, TimePoint now) noexcept;
  std::optional<Request> next_chunk(TimePoint now) noexcept;
  UploadFault missing() const noexcept;

  UploadConfig config_;
  std::span<const std::byte> image_;
  std::span<const Control> set_up_;
  Step step_ = Step::failed;
  UploadFault fault_ = UploadFault::no_image;
  int attempt_ = 0;
  TimePoint attempt_end_{};
  bool asked_ = false;
  TimePoint answer_due_{};
  std::size_t matched_ = 0;  // of the greeting's answer
  std::size_t sent_ = 0;     // of the image
  std::size_t echoed_ = 0;
};

}  // namespace farhand::falcon_usb
