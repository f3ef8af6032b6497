// A scene's words about one side's machine, as the loop takes them.
#pragma once

#include "common/realtime.hpp"
#include "common/scene_values.hpp"
#include "proto/scene.pb.h"

namespace farhand {

inline RealtimeConfig realtime_config(const proto::Realtime& r) {
  RealtimeConfig out{.spin = milliseconds(r.spin_us() * 1e-3),
                     .allow_degraded = r.allow_degraded()};
  if (r.has_cpu()) out.cpu = static_cast<int>(r.cpu());
  return out;
}

}  // namespace farhand
