// A shipped scene, and what its simulated hand does in it.
#pragma once

#include <string>

#include "common/geometry.hpp"
#include "common/scene.hpp"

namespace farhand {

inline Scene shipped(const std::string& name) {
  return load_scene(FARHAND_SOURCE_DIR "/deploy/scenes/" + name + ".textproto");
}

inline proto::Operator& hand(Scene& scene) {
  return *scene.proto.mutable_master()->mutable_sim_hand()->mutable_operator_();
}

// Times in seconds.
inline void press(proto::Operator& o, proto::Press::Button button, double at, double lasting) {
  proto::Press& p = *o.add_press();
  p.set_button(button);
  p.set_at_s(at);
  p.set_lasting_s(lasting);
}

inline void reach(proto::Motion& m, double at, double lasting, const Vec3& by) {
  proto::Reach& r = *m.add_reach();
  r.set_at_s(at);
  r.set_lasting_s(lasting);
  for (const double x : by) r.add_by_m(x);
}

// Came to be in this tick.
inline bool rises(bool now, bool& before) {
  const bool rose = now && !before;
  before = now;
  return rose;
}

}  // namespace farhand
