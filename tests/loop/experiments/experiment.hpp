// The two publications' experiments, run again: what they report, what the reference simulation
// gave, what this build gives, and pictures in the layout of their figures.
#pragma once

#include <limits>
#include <string>
#include <vector>

#include "common/report/chart.hpp"
#include "common/report/html_page.hpp"

namespace farhand {

// One number of an experiment. It passes within [low, high]; without bounds it is only told.
struct Figure {
  std::string what;
  std::string unit;
  std::string published;  // as the publication says it, or empty
  double reference = std::numeric_limits<double>::quiet_NaN();
  double ours = 0;
  double low = -std::numeric_limits<double>::infinity();
  double high = std::numeric_limits<double>::infinity();

  bool judged() const noexcept;
  bool good() const noexcept { return ours >= low && ours <= high; }
};

struct Experiment {
  std::string title;
  std::string about;  // a sentence: the set-up
  std::vector<Figure> figures;
  std::vector<Chart> charts;
  std::vector<Table> tables;  // beside that of the figures
};

// A Falcon drives its grip to a target (F1) and is pushed (F2), on either plant; the full
// simulation with the product's position control.
Experiment falcon_step();
Experiment falcon_pushes();
// Free motion: what of the device the hand feels (H1), open loop, published gains and ours; on the
// single-axis model, and on the six axes of the full simulation.
Experiment free_motion_one_axis();
Experiment free_motion_full();
// Contact in teleoperation, open (H2) and closed loop (H3), likewise.
Experiment contact_one_axis();
Experiment contact_full();
// What is left of the device against noise and margin, for every combination of stages, likewise.
Experiment pareto_one_axis();
Experiment pareto_full();
// Mass, damping and stiffness that the hand feels by frequency, for every bilateral architecture.
Experiment transparency();
// What is felt of a wall by round trip, stiffness and compensation.
Experiment delay_map();

}  // namespace farhand
