#include "master/build_falcon.hpp"

#include <algorithm>

#include "common/scene_values.hpp"
#include "master/falcon_usb/firmware_file.hpp"

namespace farhand {

FalconGeometry falcon_geometry(const proto::Falcon& f) {
  FalconGeometry g = kFalconTable1;
  switch (f.geometry()) {
    case proto::Falcon::TABLE1:
      break;
    case proto::Falcon::TABLE1_S0:
      g = kFalconTable1S0;
      break;
    case proto::Falcon::TABLE1_FLIP:
      g = kFalconTable1Flip;
      break;
    case proto::Falcon::LIBNIFALCON:
      g = kFalconLibnifalcon;
      break;
  }
  if (f.has_gear_ratio()) g.gear_ratio = f.gear_ratio();
  if (f.has_angle_offset_deg()) g.angle_offset = radians(f.angle_offset_deg());
  return g;
}

FalconUsbConfig falcon_usb_config(const Scene& scene) {
  const proto::Falcon& handle = scene.proto.master().falcon();
  const proto::FalconUsb& f = scene.proto.master().falcon_usb();
  FalconUsbConfig c{.serial = f.serial()};
  c.driver.geometry = falcon_geometry(handle);
  c.driver.counts_per_newton_meter = -f.counts_per_newton_meter();
  c.driver.max_torque = std::min(c.driver.max_torque, handle.max_motor_torque_newton_meter());
  if (f.has_firmware_file())
    c.firmware = falcon_usb::load_firmware(beside(scene, f.firmware_file()));
  return c;
}

}  // namespace farhand
