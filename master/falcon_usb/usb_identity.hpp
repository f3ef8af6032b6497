// What makes a device on the USB a Falcon, and what its refusals mean. For the files that speak
// libusb.
#pragma once

#include <libusb.h>

#include <string>

#include "master/falcon_usb/transport.hpp"

namespace farhand::falcon_usb {

inline constexpr int kInterface = 0;

// Throws a sentence if this machine has no USB. The caller ends it by libusb_exit.
libusb_context* open_usb();

Refusal refusal(int error) noexcept;

// Fills in the descriptor.
bool is_falcon(libusb_device* device, libusb_device_descriptor& d) noexcept;

// Empty if it cannot be read.
std::string serial_number(libusb_device_handle* handle, const libusb_device_descriptor& d);

}  // namespace farhand::falcon_usb
