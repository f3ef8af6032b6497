// Predicted against simulated boundaries over a grid of masses, gains, delays and walls.
#pragma once

#include <functional>

#include "tests/loop/stability/boundary.hpp"

namespace farhand {

// A scene varied, and the parameter whose boundary is looked for. Values it does not have are the
// scene's own.
struct GridPoint {
  double device_mass = 1, hand_mass = 0.4;  // [kg]
  double round_trip = 1e-4;                 // [s]
  double reflection_gain = 1;
  double loop_gain = 0;  // kp; 0: open loop
  // Instead of the published loop that of force_control.md, with its stages that know the device.
  bool hides_device = false;
  bool observes_disturbance = false;    // and with this one
  double wall_stiffness = 500;          // [N/m]
  Parameter parameter{};                // its own value above is not used
  double predicted = 0, simulated = 0;  // 0: none

  bool compared() const noexcept { return predicted > 0 && simulated > 0; }
  double difference() const noexcept { return simulated / predicted - 1; }
  std::string variant() const;  // the gains, in words
};

struct Agreement {
  std::size_t points = 0;        // with a boundary on both sides
  double median = 0, worst = 0;  // of the difference's magnitude
};

// The whole grid, or a dozen points of it.
std::vector<GridPoint> grid_points(bool small);
// Predicts and simulates one point of a scene's axis.
GridPoint compare(const Scene& scene, int surface, GridPoint point);
Agreement agreement(const std::vector<GridPoint>& points);

std::string to_text(const std::vector<GridPoint>& points);
std::string to_json(const std::vector<GridPoint>& points);

}  // namespace farhand
