// The calibration's first half: gear ratio and angle offset from poses of the grip that the user
// knows.
#pragma once

#include "master/falcon_usb/calibration.hpp"
#include "master/falcon_usb/tool/session.hpp"

namespace farhand::falcon_usb {

struct Chosen {
  const char* table;  // of lengths that fits best, as a scene says it
  GeometryFit fit;
};

// Asks for poses until they tell, and shows what each table makes of them. The device is homed.
Chosen find_geometry(Session& session);

}  // namespace farhand::falcon_usb
