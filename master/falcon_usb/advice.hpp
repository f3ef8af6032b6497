// What the user of a Falcon is to do now, in plain words.
#pragma once

#include <string>

#include "master/falcon_usb/driver_status.hpp"

namespace farhand::falcon_usb {

// One sentence: how it stands, and what to do about it. Equal for statuses of one kind, so that a
// change is news.
std::string advice(const DriverStatus& status);

}  // namespace farhand::falcon_usb
