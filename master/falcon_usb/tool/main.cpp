// farhand-falcon COMMAND: a Falcon on the USB, seen, given its firmware, tested and calibrated.
#include <cstdio>
#include <string>

#include "common/arguments.hpp"
#include "common/program.hpp"
#include "master/build_falcon.hpp"
#include "master/falcon_usb/firmware_file.hpp"
#include "master/falcon_usb/tool/commands.hpp"

namespace farhand::falcon_usb {
namespace {

struct Options {
  std::string command;
  std::string file;  // firmware
  std::optional<std::string> scene, serial, output, name;
  double duration_s = 0;
  bool no_weights = false;
};

std::string missing(const Options& o) {
  const auto is = [&](const char* name) { return o.command == name; };
  if (!is("list") && !is("info") && !is("firmware") && !is("monitor") && !is("test") &&
      !is("calibrate"))
    return "a command: list, info, firmware, monitor, test or calibrate";
  return is("firmware") && o.file.empty() ? "the firmware's file" : "";
}

FalconUsbConfig config_of(const Options& o) {
  FalconUsbConfig c;
  if (o.scene) {
    const Scene scene = load_scene(*o.scene);
    if (!scene.proto.master().has_falcon())
      throw std::runtime_error(*o.scene + " has no falcon as its master's handle");
    c = falcon_usb_config(scene);
  }
  if (o.serial) c.serial = *o.serial;
  if (!o.file.empty()) c.firmware = load_firmware(o.file);
  return c;
}

int run(const Options& o) {
  if (!o.file.empty() && o.command != "firmware")
    throw std::runtime_error(o.command + " takes no file, and " + o.file + " was given");
  if (o.command == "list") return list();
  const FalconUsbConfig c = config_of(o);
  Session session({.driver = c.driver, .serial = c.serial, .firmware = c.firmware});
  if (o.command == "info") return info(session);
  if (o.command == "firmware") return upload(session);
  if (o.command == "monitor")
    return monitor(session, c.driver.geometry,
                   o.duration_s > 0 ? from_seconds(o.duration_s) : std::chrono::hours(24 * 365));
  if (o.command == "test") return test(session, c.driver.geometry);
  return calibrate(
      session, c.driver,
      {.name = o.name.value_or("unnamed"), .file = o.output, .weights = !o.no_weights});
}

}  // namespace
}  // namespace farhand::falcon_usb

int main(int argc, char** argv) {
  using namespace farhand;
  std::setvbuf(stdout, nullptr, _IOLBF, 0);  // in order with stderr, wherever it goes
  falcon_usb::Options o;
  Arguments arguments(
      "A Novint Falcon on the USB: list those there are, info on one, firmware FILE into it, "
      "monitor "
      "it live, test it, or calibrate it",
      "farhand-falcon");
  arguments.option("command", o.command, "list, info, firmware, monitor, test or calibrate");
  arguments.option("file", o.file, "for firmware: the image, which is not part of this project");
  arguments.option("--serial", o.serial,
                   "of the one that is meant; left out, the first that opens");
  arguments.option("--scene", o.scene, "take geometry, gain, serial and firmware from a scene");
  arguments.option("-o,--output", o.output, "for calibrate: where the scene's lines go");
  arguments.option("--name", o.name, "for calibrate: what it is called, such as \"lab 2, May\"");
  arguments.flag("--no-weights", o.no_weights, "for calibrate: poses alone, no forces");
  arguments.duration(o.duration_s, "for monitor: seconds");
  if (const auto status = arguments.parse(argc, argv, [&] { return falcon_usb::missing(o); }))
    return *status;
  return run_guarded("farhand-falcon", [&] { return falcon_usb::run(o); });
}
