// farhand-loopback --stability SCENE: predicts where stability ends, finds it, and shows both.
#pragma once

#include <optional>
#include <string>

#include "common/scene.hpp"

namespace farhand {

struct StabilityOptions {
  bool asked = false;
  bool grid = false;  // the scene varied over the whole grid instead of the scene itself
  bool json = false;
  std::optional<std::string> map;  // SVG file to write
};

// Prints on standard output. Returns the exit status: 0, or 1 if the scene is beyond its boundary,
// or if prediction and simulation differ by more than a tenth.
int run_stability(const Scene& scene, const StabilityOptions& options);

}  // namespace farhand
