// The Falcon's USB chip, an FTDI FT232R: what is sent to it before and between the dialogues with
// the processor behind it.
#pragma once

#include <array>

#include "master/falcon_usb/transport.hpp"

namespace farhand::falcon_usb {

inline constexpr Control kPurgeReceived{0, 1}, kPurgeSent{0, 2};
inline constexpr Control kRtsLow{1, 0x0200}, kDtrLow{1, 0x0100}, kDtrHigh{1, 0x0101};
inline constexpr Control kNoFlowControl{2, 0}, kEightBits{4, 0x0008};
// Divisors of 3 MHz: 9600, 142 857 and 1.5 million baud.
inline constexpr Control kBaudBoot{3, 0x4138}, kBaudUpload{3, 0x0015}, kBaudPackets{3, 0x0002};
// How long the chip gathers received bytes before it hands them over [ms].
inline constexpr Control kLatencyBoot{9, 16}, kLatencyPackets{9, 1};

// For the exchange of packets, with firmware running.
inline constexpr std::array kSetUpPackets{kPurgeReceived, kPurgeSent,     kLatencyPackets,
                                          kBaudPackets,   kPurgeReceived, kPurgeSent};
// The rising edge at the end starts the boot loader.
inline constexpr std::array kSetUpBoot{kPurgeReceived, kPurgeSent, kLatencyBoot,
                                       kBaudBoot,      kEightBits, kNoFlowControl,
                                       kRtsLow,        kDtrLow,    kDtrHigh};
inline constexpr std::array kSetUpUpload{kDtrLow, kBaudUpload};

// Each packet in begins with modem and line status.
inline constexpr std::size_t kFtdiStatusBytes = 2;
inline constexpr std::size_t kFtdiPayloadBytes = kUsbPacketBytes - kFtdiStatusBytes;

inline std::span<const std::byte> payload(const UsbBytes& packet) noexcept {
  return packet.view().subspan(std::min(kFtdiStatusBytes, packet.size));
}

// Takes the first of a sequence of requests, if there is one.
inline std::optional<Request> take_first(std::span<const Control>& sequence) noexcept {
  if (sequence.empty()) return {};
  const Control first = sequence.front();
  sequence = sequence.subspan(1);
  return request_of(first);
}

}  // namespace farhand::falcon_usb
