// The doctor on a Falcon that a scene wants: is it on this machine's USB, may this user have it,
// and is its firmware at hand.
#pragma once

#include <string>
#include <vector>

#include "common/doctor.hpp"
#include "common/scene.hpp"
#include "master/falcon_usb/usb_list.hpp"

namespace farhand::falcon_usb {

// Looks at the USB if the scene's master has falcon_usb, else at nothing. Opens each Falcon for a
// moment and asks for its serial number; no packet goes to the device behind the USB.
doctor::Findings examine(const Scene& scene);

// `serial`: of the one that is meant, empty: any.
doctor::Finding device(const std::vector<Found>& found, const std::string& serial);

// A firmware file that the scene names.
doctor::Finding firmware(const Scene& scene);

}  // namespace farhand::falcon_usb
