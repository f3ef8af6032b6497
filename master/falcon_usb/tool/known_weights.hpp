// The calibration's second half: counts per newton metre, and what the grip weighs, from weights
// that the user hangs on it.
#pragma once

#include "master/falcon_usb/calibration.hpp"
#include "master/falcon_usb/tool/session.hpp"

namespace farhand::falcon_usb {

// Asks for weights until they tell, and shows how well they agree. The motors hold the grip, by the
// geometry given. Throws a sentence if they push the wrong way.
GainFit weigh(Session& session, const DriverConfig& config, const FalconGeometry& geometry);

}  // namespace farhand::falcon_usb
