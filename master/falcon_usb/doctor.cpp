#include "master/falcon_usb/doctor.hpp"

#include <spdlog/fmt/fmt.h>

#include <algorithm>

#include "common/scene_values.hpp"
#include "master/falcon_usb/advice.hpp"
#include "master/falcon_usb/firmware_file.hpp"

namespace farhand::falcon_usb {
namespace {

using doctor::Finding;
using doctor::Level;

std::string place(const Found& f) {
  return fmt::format("serial {} on bus {} device {}", f.serial.empty() ? "unknown" : f.serial,
                     f.bus, f.address);
}

// One that cannot be opened does not tell its number: it may be the one.
bool may_be(const Found& f, const std::string& serial) {
  return serial.empty() || f.serial.empty() || f.serial == serial;
}

}  // namespace

doctor::Findings examine(const Scene& scene) {
  const auto& master = scene.proto.master();
  if (!master.has_falcon_usb()) return {};
  try {
    return {device(list_falcons(), master.falcon_usb().serial()), firmware(scene)};
  } catch (const std::exception& e) {
    return {{Level::problem, "falcon", e.what()}, firmware(scene)};
  }
}

Finding device(const std::vector<Found>& found, const std::string& serial) {
  if (found.empty())
    return {Level::problem, "falcon",
            "none on the USB (0403:cb48): plug it in, with its power supply, and look at the "
            "cable"};
  std::vector<Found> meant;
  std::copy_if(found.begin(), found.end(), std::back_inserter(meant),
               [&](const Found& f) { return may_be(f, serial); });
  if (meant.empty())
    return {Level::problem, "falcon",
            fmt::format("no serial {}, but {}: plug the right one in, or say its serial in "
                        "falcon_usb",
                        serial, place(found.front()))};
  const auto free = std::find_if(meant.begin(), meant.end(),
                                 [](const Found& f) { return f.refusal == Refusal::none; });
  if (free == meant.end())
    return {Level::problem, "falcon",
            place(meant.front()) + ": " +
                advice({.phase = Phase::failed, .trouble = trouble_of(meant.front().refusal)})};
  if (free->kernel_driver)
    return {Level::warning, "falcon",
            place(*free) +
                ": a driver of the kernel's has it, and loses it while this program runs: find "
                "out which rule binds it (lsusb -t), and take that away"};
  return {Level::ok, "falcon", place(*free) + ", can be opened"};
}

Finding firmware(const Scene& scene) {
  const auto& f = scene.proto.master().falcon_usb();
  if (!f.has_firmware_file())
    return {Level::ok, "firmware", "no file named: the Falcon must run some already"};
  try {
    const std::string path = beside(scene, f.firmware_file());
    return {Level::ok, "firmware", fmt::format("{}, {} bytes", path, load_firmware(path).size())};
  } catch (const std::exception& e) {
    return {Level::problem, "firmware", e.what()};
  }
}

}  // namespace farhand::falcon_usb
