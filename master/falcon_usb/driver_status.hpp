// What the Falcon's driver tells of itself.
#pragma once

#include <cstddef>
#include <cstdint>

#include "master/falcon_usb/exchange.hpp"
#include "master/falcon_usb/firmware_upload.hpp"
#include "master/falcon_usb/transport.hpp"

namespace farhand::falcon_usb {

enum class Phase : std::uint8_t {
  absent,
  setting_up,
  probing,  // does firmware answer?
  uploading,
  homing,  // the user pulls the grip out and pushes it in
  homed,   // positions are good; waits for the gesture
  armed,
  failed,
  closed,
};

// Why the driver is not where it should be; stays until the device answers again.
enum class Trouble : std::uint8_t {
  none,
  unplugged,
  permission,
  busy,  // another program has it
  cannot_open,
  request_failed,
  silent,         // it was there and answers no more: power, or its processor
  no_firmware,    // it does not answer, and no image was given
  upload_failed,  // see the upload's fault
  not_running,    // nor does it after an upload
  jumped,         // its encoders' zero has moved
};
constexpr Trouble trouble_of(Refusal refusal) noexcept {
  if (refusal == Refusal::none) return Trouble::none;
  if (refusal == Refusal::permission) return Trouble::permission;
  return refusal == Refusal::busy ? Trouble::busy : Trouble::cannot_open;
}

struct DriverStatus {
  Phase phase = Phase::absent;
  Trouble trouble = Trouble::none;
  std::uint8_t homed = 0;  // bit i: axis i
  UploadFault upload_fault = UploadFault::none;
  int upload_attempt = 0;
  double upload_progress = 0;  // 0 to 1
  ExchangeCounters exchange;
  std::uint64_t skipped_bytes = 0;
  std::uint64_t implausible = 0;
  std::uint64_t unplugged = 0;
};

constexpr const char* to_string(Phase phase) noexcept {
  constexpr const char* kNames[] = {"absent", "setting up", "probing", "uploading", "homing",
                                    "homed",  "armed",      "failed",  "closed"};
  return kNames[static_cast<std::size_t>(phase)];
}

constexpr const char* to_string(Trouble trouble) noexcept {
  switch (trouble) {
    case Trouble::none:
      return "none";
    case Trouble::unplugged:
      return "it was unplugged";
    case Trouble::permission:
      return "this user may not open it";
    case Trouble::busy:
      return "another program has it open";
    case Trouble::cannot_open:
      return "it cannot be opened";
    case Trouble::request_failed:
      return "its USB chip does not take requests";
    case Trouble::silent:
      return "it does not answer any more";
    case Trouble::no_firmware:
      return "no firmware runs and no image was given";
    case Trouble::upload_failed:
      return "the firmware could not be uploaded";
    case Trouble::not_running:
      return "it does not answer after the upload";
    case Trouble::jumped:
      return "its encoders' zero has jumped";
  }
  return "unknown";
}

}  // namespace farhand::falcon_usb
