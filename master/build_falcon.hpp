// The Falcon's part of a scene; see build.hpp.
#pragma once

#include "common/scene.hpp"
#include "master/falcon_usb/device.hpp"

namespace farhand {

FalconGeometry falcon_geometry(const proto::Falcon& falcon);

// Of a scene whose handle is a falcon; without falcon_usb its defaults. Throws a sentence if a
// firmware file is named and cannot be read.
FalconUsbConfig falcon_usb_config(const Scene& scene);

}  // namespace farhand
