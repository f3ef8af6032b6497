#include "master/falcon_usb/usb_identity.hpp"

#include <algorithm>
#include <array>
#include <stdexcept>

namespace farhand::falcon_usb {
namespace {

constexpr std::uint16_t kVendor = 0x0403, kProduct = 0xcb48;

}  // namespace

libusb_context* open_usb() {
  libusb_context* context = nullptr;
  if (const int error = libusb_init(&context); error != LIBUSB_SUCCESS)
    throw std::runtime_error(std::string("this machine gives no access to its USB: ") +
                             libusb_strerror(static_cast<libusb_error>(error)));
  return context;
}

Refusal refusal(int error) noexcept {
  if (error == LIBUSB_ERROR_ACCESS) return Refusal::permission;
  return error == LIBUSB_ERROR_BUSY ? Refusal::busy : Refusal::other;
}

bool is_falcon(libusb_device* device, libusb_device_descriptor& d) noexcept {
  return libusb_get_device_descriptor(device, &d) == LIBUSB_SUCCESS && d.idVendor == kVendor &&
         d.idProduct == kProduct;
}

std::string serial_number(libusb_device_handle* handle, const libusb_device_descriptor& d) {
  std::array<unsigned char, 128> text{};
  const int length = libusb_get_string_descriptor_ascii(handle, d.iSerialNumber, text.data(),
                                                        static_cast<int>(text.size()));
  return {text.begin(), text.begin() + std::max(length, 0)};
}

}  // namespace farhand::falcon_usb
