#include <spdlog/fmt/fmt.h>

#include <cstdio>
#include <fstream>
#include <stdexcept>

#include "master/falcon_usb/tool/answers.hpp"
#include "master/falcon_usb/tool/commands.hpp"
#include "master/falcon_usb/tool/known_poses.hpp"
#include "master/falcon_usb/tool/known_weights.hpp"

namespace farhand::falcon_usb {
namespace {

// As a scene's text wants it between quotes.
std::string quoted(const std::string& name) {
  std::string out;
  for (const char c : name) out += (c == '"' || c == '\\' ? "\\" : "") + std::string(1, c);
  return out;
}

std::string lines(const CalibrateOptions& options, const Chosen& chosen,
                  const std::optional<GainFit>& gain) {
  std::string out = fmt::format(
      "# Into master {{ }} of a scene.\nfalcon {{\n  geometry: {}\n  gear_ratio: {:.4f}\n  "
      "angle_offset_deg: {:.3f}\n}}\nfalcon_usb {{\n  calibration: \"{}\"\n",
      chosen.table, chosen.fit.geometry.gear_ratio, chosen.fit.geometry.angle_offset / kDegree,
      quoted(options.name));
  if (gain)
    out +=
        fmt::format("  counts_per_newton_meter: {:.0f}\n", std::abs(gain->counts_per_newton_meter));
  return out + "}\n";
}

}  // namespace

int calibrate(Session& session, const DriverConfig& config, const CalibrateOptions& options) {
  session.reach(Phase::homed, kHands);
  const Chosen chosen = find_geometry(session);
  std::optional<GainFit> gain;
  if (options.weights) gain = weigh(session, config, chosen.fit.geometry);
  const std::string text = lines(options, chosen, gain);
  if (!options.file) {
    std::fputs(text.c_str(), stdout);
    return 0;
  }
  std::ofstream out(*options.file);
  if (!(out << text).flush()) {
    std::fputs(text.c_str(), stdout);
    throw std::runtime_error("cannot write " + *options.file + "; its lines are the above");
  }
  std::printf("wrote %s; put its lines into the scene's master\n", options.file->c_str());
  return 0;
}

}  // namespace farhand::falcon_usb
