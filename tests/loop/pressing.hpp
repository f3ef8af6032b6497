// A hand that presses the tool into a wall over a network of any delay and holds it there, in whole
// loops: the twin delta and the arm of twin_delta_far.
#pragma once

#include <algorithm>
#include <optional>

#include "tests/loop/checkers.hpp"
#include "tests/loop/loopback.hpp"
#include "tests/support/scene_edits.hpp"

namespace farhand {

inline constexpr double kMoved = 5.5;  // [s] free motion along the wall is over

// wall [N/m]; into it the hand wants to go by 30 mm. Before, it moves along it, or waits.
inline Scene pressing_over(double rtt_ms, double wall, bool moves_before = true) {
  Scene scene = shipped("twin_delta_far");
  proto::Link& link = *scene.proto.mutable_link();
  link.set_stale_ms(300);
  for (proto::Impairment* way : {link.mutable_to_slave(), link.mutable_to_master()}) {
    way->Clear();
    way->set_delay_ms(rtt_ms / 2);
  }
  auto& surface = *scene.proto.mutable_slave()->mutable_sim_arm()->mutable_surface(0);
  surface.set_stiffness_newton_per_m(wall);
  proto::Operator& o = hand(scene);
  o.clear_press();
  press(o, proto::Press::DEAD_MAN, 1, 100);
  o.mutable_motion()->Clear();
  if (moves_before) {
    proto::Sine& s = *o.mutable_motion()->add_sine();
    s.set_from_s(1.5), s.set_until_s(kMoved), s.set_frequency_hz(0.5);
    for (const double a : {0., 0.025, 0.}) s.add_amplitude_m(a);
  }
  reach(*o.mutable_motion(), moves_before ? kMoved + 0.5 : 2, 1.5,
        Vec3(-0.06, 0, 0));  // pressed and held
  return scene;
}

// Jitter, bursts of loss, duplicates, damage; gaps beyond stale_ms hold by rule.
inline void worsen(Scene& scene, double jitter_ms) {
  proto::Link& link = *scene.proto.mutable_link();
  link.set_stale_ms(500);
  for (proto::Impairment* way : {link.mutable_to_slave(), link.mutable_to_master()}) {
    way->set_jitter_ms(jitter_ms);
    way->set_burst_enter_ratio(0.002);
    way->set_duplicate_ratio(0.01);
    way->set_corrupt_ratio(0.001);
  }
}

struct Pressing {
  double stiffness = 0;  // [N/m] felt: of the force by how far the handle is behind the wall
  double chatter = 0;    // [m/s] rms of the handle, while held
  double drag = 0;       // [N] mean while moving freely
  double force = 0, contact = 0;  // [N] mean felt and of the robot on the wall, while held
  double peak_contact = 0;        // [N] robot on the wall
  double operator_energy = 0;  // [J] the hand's work on the handle less what came back: its least
  std::uint64_t violations = 0;
  Method method = Method::direct;  // at the end
};

inline Pressing pressed(const Scene& scene, double seconds_held) {
  const double begin = scene.proto.master().sim_hand().operator_().motion().reach(0).at_s();
  Loopback loop(scene, {.duration_s = begin + 2 + seconds_held});
  Checkers checkers(loop);
  Pressing out;
  double speed2 = 0, force = 0, depth = 0, drag = 0, energy = 0, contact = 0, contacts = 0;
  long n = 0, moving = 0;
  std::optional<double> free;  // where the handle is when the tool touches
  std::optional<Vec3> last;
  Vec3 F_last = Vec3::Zero();
  loop.on_slave = [&](const SlaveTick& t) {
    checkers.check(t);
    out.peak_contact = std::max(out.peak_contact, t.F_E_S.force.norm());
    contact = t.F_E_S.force.norm();
  };
  loop.on_master = [&](const MasterTick& t) {
    checkers.check(t);
    const double at = seconds(t.now - loop.start());
    const Vec3& p = t.handle.X_MH.p;
    if (!free && at > begin - 0.1) free = p.x();
    if (last) energy -= F_last.dot(p - *last);
    last = p, F_last = t.handle.R_MG * t.F_G.force;
    out.operator_energy = std::min(out.operator_energy, energy);
    if (at > 2.5 && at < begin - 1) drag += t.F_G.force.norm(), ++moving;  // before the wall
    if (at < begin + 1 + seconds_held) return;
    speed2 += t.out.V_MH.linear.squaredNorm();
    force += t.F_G.force.norm(), contacts += contact;
    depth += *free - 0.03 - p.x();
    out.method = t.out.method;
    ++n;
  };
  loop.run();
  out.stiffness = force / depth;
  out.force = force / static_cast<double>(n), out.contact = contacts / static_cast<double>(n);
  out.chatter = std::sqrt(speed2 / static_cast<double>(n));
  if (moving > 0) out.drag = drag / static_cast<double>(moving);
  out.violations = checkers.count();
  return out;
}

}  // namespace farhand
