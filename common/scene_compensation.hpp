// What both sides must make alike of a scene's compensation.
#pragma once

#include "common/damped.hpp"
#include "common/wave.hpp"
#include "proto/scene.pb.h"

namespace farhand {

// Whether rotation is a port, too: a handle that turns, and a tool that turns with it.
inline bool couples_rotation(const proto::Scene& scene) {
  return scene.master().has_twin_delta() && !scene.slave().workspace().rotation_lock();
}

// What the scene says of a method, named by itself or as one of several; its defaults otherwise.
inline const proto::DampedCompensation& damped(const proto::Scene& scene) {
  const proto::Compensation& c = scene.compensation();
  return c.has_auto_() ? c.auto_().damped() : c.damped();
}
inline const proto::MediatedCompensation& mediated(const proto::Scene& scene) {
  const proto::Compensation& c = scene.compensation();
  return c.has_auto_() ? c.auto_().mmt() : c.mmt();
}

// What turns a stiffness, damping or mass at the tool into the one that the handle feels.
inline double handle_terms(const proto::Scene& scene) {
  const proto::Workspace& w = scene.slave().workspace();
  return w.scale() * w.force_scale();
}

inline WaveConfig wave_translation(const proto::WaveCompensation& w, double Ts) {
  return {
      .Ts = Ts, .b = w.impedance_newton_s_per_m(), .playout = {.most = w.max_playout_ms() * 1e-3}};
}

// One port, or one axis of it; Ts [s] is the tick.
inline DampedConfig damped_port(double stiffness, double max_damping, double Ts) {
  DampedConfig c{.stiffness = stiffness, .max_damping = max_damping};
  c.delay.Ts = Ts;
  return c;
}

inline DampedConfig damped_translation(const proto::DampedCompensation& d, double Ts) {
  DampedConfig c = damped_port(d.stiffness_newton_per_m(), d.max_damping_newton_s_per_m(), Ts);
  if (d.has_touch())
    c.touch = {.force = d.touch().contact_newton(),
               .drag = d.touch().drag_newton_s_per_m(),
               .damping = d.touch().damping_newton_s_per_m()};
  return c;
}

}  // namespace farhand
