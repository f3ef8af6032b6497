// From a checked scene to the slave's parts. What the scene leaves out is not built.
#pragma once

#include <string>
#include <vector>

#include "common/scene.hpp"
#include "slave/loop.hpp"
#include "slave/robots.hpp"
#include "slave/slave.hpp"

namespace farhand {

SlaveConfig slave_config(const proto::Scene& scene);
SlaveLoopConfig slave_loop_config(const proto::Scene& scene);
AnyRobot make_robot(const proto::Scene& scene, std::uint64_t seed);

// One line per stage the slave will run, in order.
std::vector<std::string> slave_stages(const proto::Scene& scene);

}  // namespace farhand
