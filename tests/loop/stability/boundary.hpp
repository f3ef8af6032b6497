// Where an axis stops being stable along one of its parameters.
#pragma once

#include <functional>

#include "tests/loop/stability/loop_matrices.hpp"

namespace farhand {

// What is turned until the loop oscillates. Each is read from and written into a scene, so that
// analysis and simulation are given the same thing.
enum class Parameter : std::uint8_t {
  wall_stiffness,   // [N/m] of the surface
  reflection_gain,  // slave.workspace.force_scale
  loop_gain,        // kp of the closed force loop, with ki and kd in proportion
  round_trip,       // [s], half each way
  device_mass,      // [kg], the controller's model in proportion
  hand_mass,        // [kg]
};
constexpr int kParameters = 6;

struct ParameterText {
  const char* name;
  const char* unit;
  double per_unit;  // from SI to the unit
};
ParameterText text(Parameter parameter) noexcept;
// Three digits and the unit; large numbers in full.
std::string quantity(Parameter parameter, double value);

double get(const Scene& scene, int surface, Parameter parameter);
Scene with(Scene scene, int surface, Parameter parameter, double value);

// Largest magnitude of the closed loop's poles; stable below 1.
double radius(const AxisModel& model);

// A limit found by walking from where one stands.
struct StabilityLimit {
  double value = 0;     // of the last stable one; 0: none below the start; infinity: none above it
  bool beyond = false;  // the start itself is unstable
};

// The nearest boundary upwards of `start` > 0 if it is stable there, downwards if not, to 1e-4 of
// its value; the walk ends at `least` and `most`.
StabilityLimit nearest_limit(const std::function<bool(double)>& stable, double start, double least,
                             double most);

// The same for a parameter of a scene's axis, within the range that the scene's fields allow.
StabilityLimit predicted_limit(const Scene& scene, int surface, Parameter parameter);

}  // namespace farhand
