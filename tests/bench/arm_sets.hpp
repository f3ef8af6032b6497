// Sets of poses for the arm's inverse to reach, made from joints by exact forward kinematics.
#pragma once

#include <memory>
#include <random>
#include <string>
#include <vector>

#include "tests/bench/quad.hpp"

namespace farhand::bench {

struct Draw {
  std::mt19937_64 generator{20240901};
  double operator()(double low, double high) {
    return std::uniform_real_distribution<double>(low, high)(generator);
  }
  // Within the limits and a little, so that a solution nearby is within them too.
  Vec6 joints(const JointLimits& limits);
};

struct ArmTarget {
  Pose X_SE;
  Vec6 start;  // where the arm is
};
struct ArmSet {
  std::string name;
  bool reachable = true;
  bool trajectory = false;  // ticks of 1 ms, each starting where the last ended
  std::vector<ArmTarget> targets;
};

// `many` uniform configurations, started 0.05 rad per joint away; `few` each: 1e-3, 1e-6 and 1e-9
// rad from the wrist's, the elbow's and the shoulder's singularity, started 0.01 rad away on its
// own side of the shoulder's and the elbow's; the same across the shoulder's; out of reach by 1 um
// to 1 m; a smooth trajectory; one through q5 = 0.
std::vector<std::shared_ptr<const ArmSet>> arm_sets(std::size_t many, std::size_t few);

}  // namespace farhand::bench
