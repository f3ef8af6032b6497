// The seam between the Falcon's state machines and the USB: what is asked of the bus, and what it
// tells. The machines own no handle, thread or clock; a shell over libusb, or the emulator, does.
//
// A transport keeps a read pending whenever a device is attached and reports every packet that
// comes in, whole. It takes one request at a time: the next one after `sent` or `failed`, at most
// kDataTime later for bytes, kControlTime for a control. Nothing blocks, and nothing allocates once
// it is made.
#pragma once

#include <algorithm>
#include <array>
#include <chrono>
#include <concepts>
#include <cstddef>
#include <cstdint>
#include <optional>
#include <span>

#include "common/time.hpp"

namespace farhand::falcon_usb {

inline constexpr std::size_t kUsbPacketBytes = 64;  // of both bulk endpoints

// After so long a request is given up. Bytes may be torques, which soon are no longer wanted.
inline constexpr auto kDataTime = std::chrono::milliseconds(5);
inline constexpr auto kControlTime = std::chrono::milliseconds(1000);

// Up to one packet of bytes.
struct UsbBytes {
  std::array<std::byte, kUsbPacketBytes> bytes{};
  std::size_t size = 0;

  std::span<const std::byte> view() const noexcept { return std::span(bytes).first(size); }
};

// Vendor request to the device (bmRequestType 0x40), index 0, no data.
struct Control {
  std::uint8_t request = 0;
  std::uint16_t value = 0;
  bool operator==(const Control&) const = default;
};

struct Request {
  bool is_control = false;
  Control control;  // is_control
  UsbBytes data;    // otherwise: for the bulk endpoint
};
inline Request request_of(const Control& control) noexcept {
  return {.is_control = true, .control = control};
}
// The first kUsbPacketBytes of `bytes`.
inline Request request_of(std::span<const std::byte> bytes) noexcept {
  Request out;
  out.data.size = std::min(bytes.size(), kUsbPacketBytes);
  std::copy_n(bytes.begin(), out.data.size, out.data.bytes.begin());
  return out;
}

enum class EventKind : std::uint8_t {
  attached,  // found, opened, claimed
  refused,   // found, but it cannot be had
  sent,      // the request is through
  failed,    // the request is not, and the device is still there
  received,  // a packet, with the chip's two bytes of status before what it carries
  detached,  // gone, and any request with it
};

enum class Refusal : std::uint8_t { none, permission, busy, other };

struct Event {
  EventKind kind = EventKind::sent;
  Refusal refusal = Refusal::none;
  UsbBytes packet;  // received
};

template <typename T>
concept Transport = requires(T transport, const Request& request, TimePoint now) {
  { transport.submit(request, now) }
  noexcept->std::same_as<void>;
  // What happened up to now, in order, one per call; nullptr: nothing more. Valid until the next.
  { transport.next_event(now) }
  noexcept->std::same_as<const Event*>;
};

// Whoever talks over one: hears every event, and is asked for a request when none is on its way.
template <typename T>
concept Talker = requires(T talker, const Event& event, TimePoint now) {
  { talker.hear(event, now) }
  noexcept->std::same_as<void>;
  { talker.next(now) }
  noexcept->std::same_as<std::optional<Request>>;
};

// Brings both up to date.
template <Transport T, Talker D>
void pump(T& transport, D& talker, TimePoint now) noexcept {
  do {
    while (const Event* event = transport.next_event(now)) talker.hear(*event, now);
    const auto request = talker.next(now);
    if (!request) return;
    transport.submit(*request, now);
  } while (true);
}

}  // namespace farhand::falcon_usb
