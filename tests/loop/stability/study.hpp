// What the analysis says of one axis of a scene, and the sentence that warns of it.
#pragma once

#include <array>
#include <string>
#include <vector>

#include "tests/loop/stability/boundary.hpp"
#include "tests/loop/stability/felt.hpp"

namespace farhand {

// A parameter's value in the scene and the boundary nearest to it.
struct ParameterLimit {
  Parameter parameter{};
  double value = 0;
  StabilityLimit predicted;
  std::optional<double> simulated;  // with the product's own loop
};

struct AxisStudy {
  int surface = 0;
  AxisModel model;
  double radius = 0;
  std::vector<Pole> poles;
  Margins margins;  // of a stable one
  double small_gain = 0;
  FeltStiffness felt;
  std::optional<double> felt_measured;  // [N/m]
  std::vector<ParameterLimit> limits;
  // [N/m] from where on it chatters, with friction and a one-sided wall: left alone, and knocked.
  std::optional<double> chatter_stiffness, knocked_stiffness;

  bool stable() const noexcept { return radius < 1; }
};

// Analysis alone, a few milliseconds per state matrix.
AxisStudy study_axis(const Scene& scene, int surface);
// Adds what the product's own loop shows.
void simulate(const Scene& scene, AxisStudy& study);

// One sentence for each surface that the scene cannot press on without oscillating: which, how far
// beyond, and what to change. Empty without a surface, a simulated hand or force feedback, and
// with another bilateral architecture, which is not analysed.
std::vector<std::string> stability_warnings(const Scene& scene);

std::string to_text(const Scene& scene, const AxisStudy& study);
std::string to_json(const Scene& scene, const std::vector<AxisStudy>& studies);

}  // namespace farhand
