// What farhand-loopback offers beside running a scene: the publications' experiments, and where a
// scene's stability ends. Left out of sanitized builds (no_studies.cpp), which take long enough.
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "common/arguments.hpp"
#include "common/scene.hpp"
#include "tests/loop/experiments/command.hpp"
#include "tests/loop/stability/command.hpp"

namespace farhand {

class Studies {
 public:
  void add_to(Arguments& arguments);

  bool needs_scene() const noexcept { return experiment_.name.empty(); }
  // The exit status if one was asked for. `scene` may be null if none is needed.
  std::optional<int> run(const Scene* scene, bool json);
  // A sentence for each way in which the scene lies beyond its stability.
  std::vector<std::string> warnings(const Scene& scene) const;

 private:
  ExperimentOptions experiment_;
  StabilityOptions stability_;
};

}  // namespace farhand
