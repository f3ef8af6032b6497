// Guidance, boundary, mapping and position control in whole loops: no event makes the force jump,
// and the hand is always the stronger one.
#include <gtest/gtest.h>

#include "tests/loop/run.hpp"
#include "tests/loop/truth.hpp"
#include "tests/support/scene_edits.hpp"

namespace farhand::guidance_test {
namespace {

constexpr double kJumpPerMs = 0.5;  // [N]
constexpr int kReleaseTicks = 20;

struct Events {
  int engaged = 0, clutched = 0, held_by_link = 0, recovered = 0;  // each time it came to be
  int fixture = 0, boundary = 0, handle_limits = 0, left_acceptance = 0;
  double largest_jump = 0;  // [N] from one tick to the next
  double strongest = 0;     // [N]
};

Events watch(const Scene& scene, std::uint64_t seed) {
  Loopback loop(scene, {.seed = seed});
  Checkers checkers(loop);
  Events e;
  bool engaged = false, clutched = false, holding = false, fixture = false, boundary = false,
       limits = false, lost = false, outside = false;
  int released = 0;
  Vec3 last = Vec3::Zero();
  loop.on_master = [&](const MasterTick& t) {
    checkers.check(t);
    const bool on = t.mode == Mode::engaged;
    if (rises(on, engaged)) ++e.engaged, e.recovered += lost, lost = false;
    e.clutched += rises(on && t.reading.clutch, clutched);
    if (rises(t.mode == Mode::holding, holding)) ++e.held_by_link, lost = true;
    const GuidanceConfig& g = *loop.master().config().guidance;
    const double push = fixture_force(g.fixtures[0], t.handle.X_MH.p, Vec3::Zero()).norm();
    e.fixture += rises(on && push > 0, fixture);
    Handle handle = TwinDeltaHandle{};
    HandlePose pose;
    update(handle, t.reading.theta, pose);
    map_forces(handle, pose);
    e.handle_limits += rises(on && edge_wrench(handle, *g.handle_limits).force.norm() > 1, limits);
    const Vec3 f = motor_wrench(t).force;
    // Where no force is accepted the motors let go, within torque_rise_time_s.
    released = (t.limits & kLimitAcceptance) != 0 ? kReleaseTicks : std::max(0, released - 1);
    e.left_acceptance += rises(released > 0, outside);
    if (released == 0) e.largest_jump = std::max(e.largest_jump, (f - last).norm());
    e.strongest = std::max(e.strongest, f.norm());
    last = f;
  };
  loop.on_slave = [&](const SlaveTick& t) {
    checkers.check(t);
    e.boundary += rises(t.coupled && (t.limits & kLimitWorkspace) != 0, boundary);
  };
  loop.run();
  EXPECT_EQ(checkers.count(), 0u) << "seed " << seed;
  for (const Violation& v : checkers.first()) ADD_FAILURE() << v.at_s << " s: " << v.what;
  return e;
}

TEST(Guidance, EverythingItShowsIsFeltWithoutAJump) {
  const Events e = watch(shipped("twin_delta_guided"), 1);
  std::printf("guided scene: largest change of the force %.3f N per ms, largest force %.2f N\n",
              e.largest_jump, e.strongest);
  EXPECT_GE(e.fixture, 1);
  EXPECT_GE(e.boundary, 1);
  EXPECT_GE(e.handle_limits, 1);
  EXPECT_GE(e.clutched, 2);
  EXPECT_GT(e.strongest, 3);
  EXPECT_LE(e.largest_jump, kJumpPerMs * (1 + 1e-6));
}

// The same under a network that drops out again and again for longer than stale_ms, with a wall to
// touch on the robot's side and an operator who presses again and works the clutch.
TEST(Guidance, NoEventMakesTheForceJump) {
  Events all;
  for (std::uint64_t seed = 1; seed <= 3; ++seed) {
    Scene scene = shipped("twin_delta_guided");
    scene.proto.mutable_slave()->mutable_boundary()->set_elbow_margin(0.8);  // near the start
    scene.proto.mutable_slave()->mutable_force_sensing();
    auto& arm = *scene.proto.mutable_slave()->mutable_sim_arm();
    arm.mutable_force_sensor();
    auto& plane = *arm.add_surface()->mutable_plane();
    for (const double x : {0.06, 0.326, 0.389}) plane.add_point_m(x);  // behind the handle's wall
    for (const double x : {-1.0, 0.0, 0.0}) plane.add_normal(x);
    proto::Operator& o = hand(scene);
    o.clear_press();
    for (int k = 0; k < 20; ++k) {
      press(o, proto::Press::DEAD_MAN, 0.5 + k, 0.9);
      press(o, proto::Press::CLUTCH, 1.05 + k, 0.15);
    }
    for (proto::Impairment* way : {scene.proto.mutable_link()->mutable_to_slave(),
                                   scene.proto.mutable_link()->mutable_to_master()}) {
      way->set_delay_ms(2);
      way->set_jitter_ms(0.5);
      way->set_burst_enter_ratio(0.001);
      way->set_burst_leave_ratio(0.02);
    }
    const Events e = watch(scene, seed);
    EXPECT_LE(e.largest_jump, kJumpPerMs * (1 + 1e-6)) << "seed " << seed;
    all.engaged += e.engaged, all.clutched += e.clutched, all.held_by_link += e.held_by_link;
    all.recovered += e.recovered, all.fixture += e.fixture, all.boundary += e.boundary;
    all.handle_limits += e.handle_limits;
    all.largest_jump = std::max(all.largest_jump, e.largest_jump);
  }
  std::printf(
      "three lossy runs: engaged %d, clutched %d, link lost %d, recovered %d, wall %d, boundary "
      "%d, "
      "handle limits %d times; largest change of the force %.3f N per ms\n",
      all.engaged, all.clutched, all.held_by_link, all.recovered, all.fixture, all.boundary,
      all.handle_limits, all.largest_jump);
  EXPECT_GE(all.engaged, 20);
  EXPECT_GE(all.clutched, 10);
  EXPECT_GE(all.held_by_link, 5);
  EXPECT_GE(all.recovered, 5);
  EXPECT_GE(all.fixture, 3);
  EXPECT_GE(all.boundary, 1);
}

// A wall as stiff as allowed and a strong hand: it stands against the cap, goes through, and comes
// back.
TEST(Guidance, TheHandIsStrongerThanEveryWall) {
  Scene scene = shipped("twin_delta_guided");
  auto& fixture = *scene.proto.mutable_master()->mutable_guidance()->mutable_fixture(0);
  fixture.set_stiffness_newton_per_m(3000);
  fixture.set_damping_newton_s_per_m(10);
  proto::Operator& o = hand(scene);
  o.set_stiffness_newton_per_m(2000);
  o.set_damping_newton_s_per_m(60);
  o.mutable_motion()->clear_reach();
  reach(*o.mutable_motion(), 1, 1.5, Vec3(0, 0.07, 0));
  reach(*o.mutable_motion(), 4, 1.5, Vec3(0, -0.07, 0));
  Loopback loop(scene, {.duration_s = 7});
  double strongest = 0, furthest = 0, last_force = 0;
  loop.on_master = [&](const MasterTick& t) {
    strongest = std::max(strongest, motor_wrench(t).force.norm());
    furthest = std::max(furthest, t.handle.X_MH.p.y());
    last_force = t.F_G.force.norm();
  };
  loop.run();
  std::printf(
      "a wall of 3000 N/m and 8 N at 20 mm: the hand went to %.1f mm, felt %.2f N at most\n",
      furthest * 1e3, strongest);
  EXPECT_LE(strongest, 8 + 1e-6);
  EXPECT_GT(strongest, 7.9);
  EXPECT_GT(furthest, 0.06);
  EXPECT_LT(last_force, 0.1);
}

// Far beyond the elbow's margin, where the arm would fold, the hand still feels no more than the
// boundary's cap; the robot has stopped at its edge and follows again at once.
TEST(Guidance, TheHandIsStrongerThanTheRobotsEdge) {
  Scene scene = shipped("twin_delta_guided");
  scene.proto.mutable_master()->clear_guidance();
  scene.proto.mutable_slave()->mutable_workspace()->set_rotation_lock(false);
  auto& boundary = *scene.proto.mutable_slave()->mutable_boundary();
  boundary.set_elbow_margin(0.75);
  proto::Operator& o = hand(scene);
  o.mutable_motion()->clear_reach();
  reach(*o.mutable_motion(), 1, 2, Vec3(0.058, 0, 0));
  reach(*o.mutable_motion(), 4, 2, Vec3(-0.058, 0, 0));
  Loopback loop(scene, {.duration_s = 7});
  Checkers checkers(loop);
  double strongest = 0, least_cos = 1, end_error = 1, back_at = 0;
  loop.on_master = [&](const MasterTick& t) {
    checkers.check(t);
    strongest = std::max(strongest, motor_wrench(t).force.norm());
  };
  loop.on_slave = [&](const SlaveTick& t) {
    checkers.check(t);
    const ArmKinematics at = kinematics(loop.slave()->config().arm, t.q_cmd);
    least_cos = std::min(least_cos, at.singularity.elbow);
    const double wish_to_target =
        (loop.slave()->workspace().X_SE_target.p - t.X_SE_target.p).norm();
    if (wish_to_target > 1e-9) back_at = seconds(t.now - loop.start());
    end_error = (t.X_SE.p - t.X_SE_target.p).norm();
  };
  loop.run();
  EXPECT_EQ(checkers.count(), 0u);
  std::printf("at the elbow's margin: felt %.2f N at most, least cos q3 %.4f\n", strongest,
              least_cos);
  EXPECT_NEAR(least_cos, 0.75, 1e-6);
  EXPECT_LE(strongest, 8 + 1e-6);
  EXPECT_GT(strongest, 7.9);
  EXPECT_GT(back_at, 4);
  EXPECT_LT(back_at, 6);
  EXPECT_LT(end_error, 0.002);
}

// With the orientation kept, the handle's turns never reach the tool, over clutching and all.
TEST(Guidance, UnderRotationLockTheToolNeverTurns) {
  Scene scene = shipped("twin_delta_guided");
  auto& sine = *hand(scene).mutable_motion()->add_sine();
  sine.set_frequency_hz(0.3);
  for (int i = 0; i < 3; ++i) sine.add_amplitude_deg(10);
  Loopback loop(scene, {.duration_s = 12});
  std::optional<Mat3> R;
  double most = 0, handle_turn = 0;
  loop.on_master = [&](const MasterTick& t) {
    handle_turn = std::max(handle_turn, rotation_vector(t.handle.X_MH.R).norm());
  };
  loop.on_slave = [&](const SlaveTick& t) {
    if (!t.coupled) return;
    if (!R) R = t.X_SE_target.R;
    most = std::max(most, (t.X_SE_target.R - *R).norm());
  };
  loop.run();
  EXPECT_GT(handle_turn, 0.2);
  EXPECT_LT(most, 1e-9);
}

// ---- position control

struct CueRun {
  double fastest_travel = 0, fastest_return = 0;  // [m/s] of the true grip
  double shift_front = 0, shift_left = 0;         // [m] of the target
  double felt_front = 0;                          // [N] change of the force on the hand
  double pushed = 0;                              // [m] off target
  double at_return = 1, at_park = 1, at_end = 1;  // [m] off target
  double strongest = 0;
};

TEST(PositionControl, TheCueIsFeltWithinBoundsAndAStrongerHandIsObeyed) {
  const Scene scene = shipped("falcon_cue");
  Loopback loop(scene, {});
  Checkers checkers(loop);
  CueRun r;
  Vec3 before_cue = Vec3::Zero();
  const Vec3 set_point(-0.02, 0, 0.115), park(0, -0.02, 0.1);
  loop.on_master = [&](const MasterTick& t) {
    checkers.check(t);
    const double s = seconds(t.now - loop.start());
    const auto& state = std::get<SimHand<FalconGeometry>>(loop.device()).truth().state;
    const double speed = state.v_MH.norm(), off = (state.p_MH - t.p_MH_target).norm();
    r.strongest = std::max(r.strongest, t.F_G.force.norm());
    if (s < 4) r.fastest_travel = std::max(r.fastest_travel, speed), before_cue = t.F_G.force;
    if (s > 4 && s < 5) {
      r.shift_front = (t.p_MH_target - set_point).z();
      r.felt_front = std::max(r.felt_front, (t.F_G.force - before_cue).norm());
    }
    if (s > 6 && s < 7) r.shift_left = (t.p_MH_target - set_point).x();
    if (s > 9 && s < 11) r.pushed = std::max(r.pushed, off);
    if (s > 9 && s < 13.9) r.fastest_return = std::max(r.fastest_return, -state.v_MH.x());
    if (s < 13.9) r.at_return = (state.p_MH - set_point).norm();
    if (s < 17) r.at_park = (state.p_MH - park).norm();
    r.at_end = (state.p_MH - set_point).norm();
  };
  loop.run();
  EXPECT_EQ(checkers.count(), 0u);
  for (const Violation& v : checkers.first()) ADD_FAILURE() << v.at_s << " s: " << v.what;
  std::printf(
      "cue: shifts %.1f and %.1f mm, felt %.2f N; travel %.3f m/s; pushed %.1f mm, back at %.3f "
      "m/s, "
      "then %.2f mm off, parked %.2f mm off, at the end %.2f mm off; at most %.2f N\n",
      r.shift_front * 1e3, r.shift_left * 1e3, r.felt_front, r.fastest_travel, r.pushed * 1e3,
      r.fastest_return, r.at_return * 1e3, r.at_park * 1e3, r.at_end * 1e3, r.strongest);
  EXPECT_NEAR(r.shift_front, 0.02, 1e-9);
  EXPECT_NEAR(r.shift_left, 0.01, 1e-9);
  EXPECT_GT(r.felt_front, 0.3);
  EXPECT_LE(r.felt_front, 3.5);
  EXPECT_LE(r.fastest_travel, 0.1);
  EXPECT_GT(r.pushed, 0.03);
  // The hand's own spring helps: at the safe speed the motors' share is nothing but a damper.
  const double hand_pull = 20 * r.pushed, damper = (8 - 0.3 * 9.81) / 0.1 + 8;
  EXPECT_LE(r.fastest_return, 0.1 + hand_pull / damper);
  // The grip may rest where the spring no longer overcomes the device's friction.
  constexpr double kRests = 0.5 / 150;
  EXPECT_LE(r.at_return, kRests);
  EXPECT_LE(r.at_park, kRests);
  EXPECT_LE(r.at_end, kRests);
}

// The robot of a held handle is pressed against a wall: the grip is drawn back from it, by its
// share of 10 N, and comes back when the hand lets it.
TEST(PositionControl, TheCueTellsOfWhatTheRobotPressesOn) {
  Scene scene = shipped("falcon_arm");
  proto::Master& m = *scene.proto.mutable_master();
  m.clear_force_feedback();
  proto::PositionControl& control = *m.mutable_position_control();
  control.set_max_speed_m_per_s(0.1);
  control.mutable_danger_cue()->set_contact_newton(10);
  proto::Motion& motion = *hand(scene).mutable_motion();
  motion.clear_sine();
  motion.clear_reach();
  reach(motion, 2, 1.5, Vec3(0, 0, -0.03));
  reach(motion, 6, 1.5, Vec3(0, 0, 0.03));
  Loopback loop(scene, {.duration_s = 10});
  Checkers checkers(loop);
  double free_shift = 0, largest = 0, end = 1, strongest = 0;
  Vec3 home = Vec3::Zero(), contact = Vec3::Zero();
  loop.on_master = [&](const MasterTick& t) {
    checkers.check(t);
    EXPECT_TRUE(t.out.force_wanted);
    const double s = seconds(t.now - loop.start());
    if (s < 0.2) home = t.p_MH_target;
    const Vec3 shift = t.p_MH_target - home;
    if (s < 2) free_shift = std::max(free_shift, shift.norm());
    largest = std::max(largest, shift.z());
    strongest = std::max(strongest, t.F_G.force.norm());
    end = shift.norm();
    if (s < 5.9) contact = loop.heard() != nullptr ? loop.heard()->F_E_M.force : contact;
    if (s > 5.8 && s < 5.9) {
      EXPECT_NEAR(shift.z(), -0.02 * contact.z() / 10, 1e-3);
    }
  };
  loop.on_slave = [&](const SlaveTick& t) { checkers.check(t); };
  loop.run();
  EXPECT_EQ(checkers.count(), 0u);
  for (const Violation& v : checkers.first()) ADD_FAILURE() << v.at_s << " s: " << v.what;
  std::printf(
      "cue of contact: shift %.2f mm free, %.1f mm pressing by %.1f N, %.2f mm at the end\n",
      free_shift * 1e3, largest * 1e3, contact.norm(), end * 1e3);
  // The sensor's noise alone, 0.05 N on each axis.
  EXPECT_LE(free_shift, 0.02 * 6 * 0.05 / 10);
  EXPECT_LE(end, 0.02 * 6 * 0.05 / 10);
  EXPECT_GT(largest, 0.002);
  EXPECT_LE(strongest, 8 * (1 + 1e-9));
}

}  // namespace
}  // namespace farhand::guidance_test
