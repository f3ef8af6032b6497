// The closed force loop in whole loops, in contact: whatever begins or ends (engaging, releasing,
// the clutch, a link that drops out, force sensors that fall silent, a device that does not read),
// for 0.2 s the force on the hand changes by at most 0.5 N per ms and the torque by a quarter of
// its rate; else both by their rates, which a contact may use; and the hand is stronger than all of
// it.
#include <gtest/gtest.h>

#include "tests/loop/checkers.hpp"
#include "tests/loop/loopback.hpp"
#include "tests/loop/truth.hpp"
#include "tests/support/scene_edits.hpp"

namespace farhand::events_test {
namespace {

constexpr double kJumpPerMs = 0.5;  // [N]
constexpr int kReleaseTicks = 20;   // torque_rise_time_s, in which motors let go
constexpr int kEventTicks = 200;    // in which a coupling must not jerk
constexpr double kRounding = 1e-6;  // relative: from torques back to a wrench

struct Events {
  int engaged = 0, clutched = 0, held_by_link = 0, sensor_lost = 0, not_read = 0, touched = 0;
  // Commanded, from one tick to the next [N], [N m]: by an event, and else.
  double force_jump = 0, torque_jump = 0, contact_jump = 0, contact_torque_jump = 0;
  double felt_jump = 0;    // [N] of the motors' torques by an event, and
  double let_go_jump = 0;  // [N] while the device does not answer and just after
  double strongest = 0, strongest_torque = 0, strongest_felt = 0;
  double furthest = 0;  // [m] of the handle from where it started

  void add(const Events& e) {
    engaged += e.engaged, clutched += e.clutched, held_by_link += e.held_by_link;
    sensor_lost += e.sensor_lost, not_read += e.not_read, touched += e.touched;
    for (const auto member : {&Events::force_jump, &Events::torque_jump, &Events::contact_jump,
                              &Events::contact_torque_jump, &Events::felt_jump,
                              &Events::let_go_jump, &Events::strongest, &Events::strongest_torque,
                              &Events::strongest_felt, &Events::furthest})
      this->*member = std::max(this->*member, e.*member);
  }
};

void print(const char* what, const Events& e) {
  std::printf(
      "%s: engaged %d, clutched %d, link lost %d, sensors lost %d, device not read %d, touched %d "
      "times; largest change per ms after these %.4f N and %.5f N m commanded, %.4f N by the "
      "motors (%.2f N where the device does not answer), else %.4f N and %.5f N m; at most "
      "%.2f N, %.3f N m, %.2f N by the motors; the hand went %.1f mm\n",
      what, e.engaged, e.clutched, e.held_by_link, e.sensor_lost, e.not_read, e.touched,
      e.force_jump, e.torque_jump, e.felt_jump, e.let_go_jump, e.contact_jump,
      e.contact_torque_jump, e.strongest, e.strongest_torque, e.strongest_felt, e.furthest * 1e3);
}

// What began or ended, as the hand would see it.
struct Coupling {
  bool engaged = false, in_touch = false, coupled = false, late = false, sensed = false,
       read = false;
  bool operator==(const Coupling&) const = default;
};
Coupling coupling(const MasterTick& t) {
  return {.engaged = t.mode == Mode::engaged,
          .in_touch = t.mode == Mode::engaged || t.mode == Mode::holding,
          .coupled = t.coupled,
          .late = (t.limits & kLimitStale) != 0,
          .sensed = t.reading.has_force,
          .read = t.reading.ok};
}

// `spoil` may change a reading of this time [s].
Events watch(const Scene& scene, std::uint64_t seed,
             const std::function<void(HandleReading&, double)>& spoil = {}) {
  Loopback loop(scene, {.seed = seed});
  Checkers checkers(loop);
  Events e;
  bool engaged = false, clutched = false, holding = false, senseless = false, unread = false,
       touching = false, sent_back = false;
  int released = 0, event = 0;
  Coupling last_coupling;
  Wrench last, last_felt;
  std::optional<Vec3> start;
  if (spoil)
    loop.on_reading = [&](HandleReading& r) { spoil(r, seconds(loop.now() - loop.start())); };
  loop.on_master = [&](const MasterTick& t) {
    checkers.check(t);
    const bool on = t.mode == Mode::engaged;
    e.engaged += rises(on, engaged);
    e.clutched += rises(on && t.reading.clutch, clutched);
    e.held_by_link += rises(t.mode == Mode::holding, holding);
    e.sensor_lost += rises(on && !t.reading.has_force, senseless);
    e.not_read += rises(!t.reading.ok, unread);
    e.touched += rises(on && t.F_env_G.force.norm() > 1, touching);
    sent_back |= (t.limits & kLimitAcceptance) != 0;
    if (!start && t.reading.ok) start = t.handle.X_MH.p;
    e.furthest = std::max(e.furthest, (t.handle.X_MH.p - *start).norm());
    event = coupling(t) == last_coupling ? std::max(0, event - 1) : kEventTicks;
    last_coupling = coupling(t);
    double& force_jump = event > 0 ? e.force_jump : e.contact_jump;
    double& torque_jump = event > 0 ? e.torque_jump : e.contact_torque_jump;
    force_jump = std::max(force_jump, (t.F_G.force - last.force).norm());
    torque_jump = std::max(torque_jump, (t.F_G.torque - last.torque).norm());
    e.strongest = std::max(e.strongest, t.F_G.force.norm());
    e.strongest_torque = std::max(e.strongest_torque, t.F_G.torque.norm());
    last = t.F_G;
    const Wrench felt = motor_wrench(t);
    released = t.reading.ok ? std::max(0, released - 1) : kReleaseTicks;
    double& jump = released > 0 ? e.let_go_jump : e.felt_jump;
    if (event > 0) jump = std::max(jump, (felt.force - last_felt.force).norm());
    e.strongest_felt = std::max(e.strongest_felt, felt.force.norm());
    last_felt = felt;
  };
  loop.on_slave = [&](const SlaveTick& t) { checkers.check(t); };
  loop.run();
  EXPECT_FALSE(sent_back) << "outside the accepted workspace the motors let go, seed " << seed;
  EXPECT_EQ(checkers.count(), 0u) << "seed " << seed;
  for (const Violation& v : checkers.first()) ADD_FAILURE() << v.at_s << " s: " << v.what;
  return e;
}

// In and out of the wall, pressed 30 mm into it, the buttons worked all the time.
Scene eventful() {
  Scene scene = shipped("twin_delta_closed");
  proto::Operator& o = hand(scene);
  o.clear_press();
  for (int k = 0; k < 20; ++k) {
    press(o, proto::Press::DEAD_MAN, 0.5 + k, 0.9);
    press(o, proto::Press::CLUTCH, 1.05 + k, 0.15);
    press(o, proto::Press::CLUTCH, 1.42 + k, 0.05);  // dead-man released: leaves a fault
  }
  proto::Motion& m = *o.mutable_motion();
  m.clear_sine();
  m.clear_reach();
  proto::Sine& turn = *m.add_sine();
  turn.set_frequency_hz(0.3);
  for (const double a : {8.0, 10.0, 15.0}) turn.add_amplitude_deg(a);
  for (int k = 0; k < 9; ++k) {
    reach(m, 1.55 + 2 * k, 0.3, Vec3(-0.06, 0, 0));
    reach(m, 2.6 + 2 * k, 0.3, Vec3(0.06, 0, 0));
  }
  return scene;
}

void drop_out(Scene& scene) {
  for (proto::Impairment* way : {scene.proto.mutable_link()->mutable_to_slave(),
                                 scene.proto.mutable_link()->mutable_to_master()}) {
    way->set_delay_ms(1);
    way->set_jitter_ms(0.3);
    way->set_burst_enter_ratio(0.002);
    way->set_burst_leave_ratio(0.01);
  }
}

void expect_smooth(const Scene& scene, const Events& e) {
  const proto::ForceFeedback& f = scene.proto.master().force_feedback();
  const double room = 1 + kRounding, Ts = 1 / scene.proto.rate_hz();
  const double torque_step = f.max_torque_rate_newton_meter_per_s() * Ts;
  EXPECT_LE(e.force_jump, kJumpPerMs * room);
  EXPECT_LE(e.felt_jump, kJumpPerMs * room);
  EXPECT_LE(e.torque_jump, f.switching_rate_share() * torque_step * room);
  EXPECT_LE(e.contact_jump, f.max_force_rate_newton_per_s() * Ts * room);
  EXPECT_LE(e.contact_torque_jump, torque_step * room);
}

TEST(Events, OfButtonsAndLinkMakeNoJumpInTheClosedLoop) {
  Scene scene = eventful();
  drop_out(scene);
  Events all;
  for (std::uint64_t seed = 1; seed <= 3; ++seed) all.add(watch(scene, seed));
  print("closed loop, lossy link", all);
  expect_smooth(scene, all);
  EXPECT_GE(all.engaged, 20);
  EXPECT_GE(all.clutched, 10);
  EXPECT_GE(all.held_by_link, 5);
  EXPECT_GE(all.touched, 5);
}

// The force sensors fall silent for 30 ms five times a second, and every three seconds the device
// does not answer for 50 ms; then there is nothing to map a force by, and the motors let go by
// their own slew limit.
TEST(Events, OfSensorsAndDeviceMakeNoJumpInTheClosedLoop) {
  const Scene scene = eventful();
  const Events e = watch(scene, 1, [](HandleReading& r, double t) {
    if (std::fmod(t, 0.2) < 0.03) r.has_force = false;
    if (std::fmod(t, 3) < 0.05 && t > 1) r.ok = false;
  });
  print("closed loop, sensors and device failing", e);
  expect_smooth(scene, e);
  EXPECT_GE(e.sensor_lost, 50);
  EXPECT_GE(e.not_read, 5);
  EXPECT_GE(e.engaged, 15);
  EXPECT_GE(e.touched, 5);
}

// A hand of 2000 N/m wishes to be 60 mm further on, where the robot meets a hard wall and the
// handle one of its own: it gets there but for what the cap holds it back.
TEST(Events, TheHandIsStrongerThanTheClosedLoopAndItsGuidance) {
  constexpr double kCap = 8, kHand = 2000, kWish = 0.06;  // [N], [N/m], [m]
  for (const bool guided : {false, true}) {
    Scene scene = shipped("twin_delta_closed");
    scene.proto.set_duration_s(6);
    proto::Master& m = *scene.proto.mutable_master();
    m.mutable_force_feedback()->set_max_force_newton(kCap);
    scene.proto.mutable_slave()->mutable_sim_arm()->mutable_surface(0)->set_stiffness_newton_per_m(
        guided ? 1 : 3000);
    if (guided) {
      proto::Fixture& f = *m.mutable_guidance()->add_fixture();
      for (const double x : {0.16, 0.0, 0.0}) f.mutable_plane()->add_point_m(x);
      for (const double x : {1.0, 0.0, 0.0}) f.mutable_plane()->add_normal(x);
      f.set_stiffness_newton_per_m(3000);
      f.set_max_force_newton(100);
    }
    proto::Operator& o = hand(scene);
    o.clear_press();
    o.set_stiffness_newton_per_m(kHand);
    o.set_damping_newton_s_per_m(60);
    o.mutable_motion()->clear_sine();
    o.mutable_motion()->clear_reach();
    reach(*o.mutable_motion(), 1.5, 1.5, Vec3(-kWish, 0, 0));
    const Events e = watch(scene, 1);
    print(guided ? "closed loop against the cap of a wall at the handle"
                 : "closed loop against the cap of a hard contact",
          e);
    expect_smooth(scene, e);
    EXPECT_LE(e.strongest, kCap * (1 + kRounding));
    EXPECT_LE(e.strongest_felt, kCap * (1 + kRounding));
    EXPECT_GT(e.strongest, 0.99 * kCap);
    // What else holds the hand back: the device's weight and friction.
    EXPECT_GT(e.furthest, kWish - (kCap + 2.0 + 0.8) / kHand);
  }
}

}  // namespace
}  // namespace farhand::events_test
