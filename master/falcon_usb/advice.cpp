#include "master/falcon_usb/advice.hpp"

namespace farhand::falcon_usb {
namespace {

// For the troubles that leave the driver without a device.
std::string remedy(const DriverStatus& status) {
  switch (status.trouble) {
    case Trouble::permission:
      return "install the udev rule 60-farhand-falcon.rules, see that you are in group plugdev, "
             "and plug it in again";
    case Trouble::busy:
      return "end the other program";
    case Trouble::no_firmware:
      return "give it the image by farhand-falcon firmware FILE, or name firmware_file in the "
             "scene; if it had one, see that its own power supply is plugged in";
    case Trouble::upload_failed:
      return std::string(to_string(status.upload_fault)) +
             "; see that its power supply is plugged in, connect it without a hub, and plug it in "
             "again";
    case Trouble::not_running:
      return "see that the image is one for the Falcon, that the power supply is plugged in, and "
             "plug it in again";
    default:
      return "plug it in again, without a hub if there is one";
  }
}

std::string homing(const DriverStatus& status) {
  const std::string why =
      status.trouble == Trouble::none ? "" : std::string(to_string(status.trouble)) + ": ";
  return why +
         "pull the grip all the way out, then push it all the way in, until the light turns blue";
}

}  // namespace

std::string advice(const DriverStatus& status) {
  switch (status.phase) {
    case Phase::absent:
      return status.trouble == Trouble::unplugged ? "unplugged; plug it in again"
                                                  : "not found; plug it in, with its power supply";
    case Phase::setting_up:
    case Phase::probing:
      return status.trouble == Trouble::silent
                 ? "it does not answer any more; see that its power supply is plugged in"
                 : "found, wait";
    case Phase::uploading:
      return "the firmware is being uploaded, wait";
    case Phase::homing:
      return homing(status);
    case Phase::homed:
      return "homed; for force, hold the centre and the forward button together for half a second, "
             "then let go";
    case Phase::armed:
      return "armed";
    case Phase::failed:
      return std::string(to_string(status.trouble)) + "; " + remedy(status);
    case Phase::closed:
      return "closed";
  }
  return {};
}

}  // namespace farhand::falcon_usb
