// What both sides must make alike of a scene's compensation.
#pragma once

#include "common/damped.hpp"
#include "proto/scene.pb.h"

namespace farhand {

// Whether rotation is a port, too: a handle that turns, and a tool that turns with it.
inline bool couples_rotation(const proto::Scene& scene) {
  return scene.master().has_twin_delta() && !scene.slave().workspace().rotation_lock();
}

// One port, or one axis of it; Ts [s] is the tick.
inline DampedConfig damped_port(double stiffness, double max_damping, double Ts) {
  DampedConfig c{.stiffness = stiffness, .max_damping = max_damping};
  c.delay.Ts = Ts;
  return c;
}

}  // namespace farhand
