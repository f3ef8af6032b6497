// What farhand-falcon can do. Each prints for a person, throws a sentence that ends it, and gives
// the program's exit status: 0, or 1 if what it looked at is not as it should be.
#pragma once

#include <optional>
#include <string>

#include "master/falcon_usb/tool/session.hpp"

namespace farhand::falcon_usb {

// The Falcons on the USB, one per line.
int list();

// Firmware, homing, encoders, buttons, rate: what can be seen without moving anything.
int info(Session& session);

// Gives the firmware to a device that runs none, with a progress bar.
int upload(Session& session);

// A line that follows the device until Ctrl-C, or for so long.
int monitor(Session& session, const FalconGeometry& geometry, Duration most);

// Exchange, homing, buttons and forces, one after the other, with the user's help.
int test(Session& session, const FalconGeometry& geometry);

// Guides the user through known poses and known weights, fits, shows residuals, and writes the
// scene's lines to `file`, or to stdout.
struct CalibrateOptions {
  std::string name;  // of the calibration
  std::optional<std::string> file;
  bool weights = true;  // else poses alone: no force is needed
};
int calibrate(Session& session, const DriverConfig& config, const CalibrateOptions& options);

}  // namespace farhand::falcon_usb
