#include "master/falcon_usb/usb_list.hpp"

#include <memory>

#include "master/falcon_usb/usb_identity.hpp"

namespace farhand::falcon_usb {
namespace {

// The serial number, and what opening came to.
Found look_at(libusb_device* device, const libusb_device_descriptor& d) {
  Found out{.bus = libusb_get_bus_number(device), .address = libusb_get_device_address(device)};
  libusb_device_handle* handle = nullptr;
  if (const int error = libusb_open(device, &handle); error != LIBUSB_SUCCESS) {
    out.refusal = refusal(error);
    return out;
  }
  out.serial = serial_number(handle, d);
  out.kernel_driver = libusb_kernel_driver_active(handle, kInterface) == 1;
  const int error = out.kernel_driver ? 0 : libusb_claim_interface(handle, kInterface);
  if (error != LIBUSB_SUCCESS) out.refusal = refusal(error);
  libusb_close(handle);
  return out;
}

}  // namespace

std::vector<Found> list_falcons() {
  libusb_context* context = open_usb();
  const std::unique_ptr<libusb_context, void (*)(libusb_context*)> ends(context, libusb_exit);
  libusb_device** list = nullptr;
  const ssize_t count = libusb_get_device_list(context, &list);
  std::vector<Found> out;
  for (ssize_t i = 0; i < count; ++i) {
    libusb_device_descriptor d{};
    if (is_falcon(list[i], d)) out.push_back(look_at(list[i], d));
  }
  if (list != nullptr) libusb_free_device_list(list, 1);
  return out;
}

}  // namespace farhand::falcon_usb
