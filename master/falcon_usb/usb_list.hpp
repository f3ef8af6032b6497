// Which Falcons are on the USB.
#pragma once

#include <string>
#include <vector>

#include "master/falcon_usb/transport.hpp"

namespace farhand::falcon_usb {

struct Found {
  int bus = 0, address = 0;
  Refusal refusal = Refusal::none;  // of opening it
  std::string serial;               // empty if it cannot be read
  bool kernel_driver = false;       // one of the kernel's has it, which can be taken away from it
};

// Opens each for a moment. Throws a sentence if this machine has no USB.
std::vector<Found> list_falcons();

}  // namespace farhand::falcon_usb
