// The model-mediated method, and `auto`, in whole loops: the twin delta and the arm, over networks
// of any delay.
#include <gtest/gtest.h>

#include "common/energy_budget.hpp"
#include "tests/loop/pressing.hpp"

namespace farhand {
namespace {

Scene mediated_over(double rtt_ms, double wall, bool moves_before = true) {
  Scene scene = pressing_over(rtt_ms, wall, moves_before);
  scene.proto.mutable_compensation()->mutable_mmt();
  return scene;
}

void print(double rtt, double wall, const Pressing& h) {
  std::printf(
      "%3.0f ms, wall %4.0f N/m: felt %.3f of it, drag %.2f N, handle %.2f mm/s rms, robot presses "
      "%.1f N at most, operator's energy %.4f J, %s\n",
      rtt, wall, h.stiffness / wall, h.drag, h.chatter * 1e3, h.peak_contact, h.operator_energy,
      to_string(h.method));
}

void expect_safe(double rtt, double wall, const Pressing& h) {
  print(rtt, wall, h);
  EXPECT_EQ(h.violations, 0u);
  EXPECT_LT(h.chatter, 0.005) << rtt << ' ' << wall;
  EXPECT_LE(h.drag, 0.8) << rtt << ' ' << wall;
  EXPECT_LE(h.peak_contact, 25) << rtt << ' ' << wall;
  EXPECT_GE(h.operator_energy, -kEnergyStore) << rtt << ' ' << wall;
}

void expect_felt(double rtt, double wall, const Pressing& h) {
  expect_safe(rtt, wall, h);
  EXPECT_GE(h.stiffness / wall, wall > 2000 ? 0.75 : 0.90) << rtt << ' ' << wall;
  EXPECT_LE(h.stiffness / wall, 1.15) << rtt << ' ' << wall;
  EXPECT_LT(h.chatter, 0.003) << rtt << ' ' << wall;
}

TEST(MediatedLoop, FeelsTheWallAtAnyDelay) {
  for (const double rtt : {2., 20., 100., 200., 400.})
    for (const double wall : {200., 1000.})
      expect_felt(rtt, wall, pressed(mediated_over(rtt, wall), 6));
  for (const double rtt : {2., 20., 100., 200.})
    expect_felt(rtt, 5000, pressed(mediated_over(rtt, 5000), 6));
}

// In 400 ms the hand is deeper in such a wall than its tank pays for to be pushed out: it is pushed
// a part of the way, and the force is steady there.
TEST(MediatedLoop, HoldsTheForceThatASmallTankPaysFor) {
  const Pressing h = pressed(mediated_over(400, 5000), 6);
  expect_safe(400, 5000, h);
  EXPECT_GE(h.stiffness / 5000, 0.15);
  EXPECT_LT(h.chatter, 0.003);
}

TEST(MediatedLoop, FeelsSuchAWallFromALargerTankThatFreeMotionFilled) {
  Scene scene = mediated_over(400, 5000);
  scene.proto.mutable_compensation()->mutable_mmt()->set_max_tank_joule(0.4);
  hand(scene).mutable_motion()->mutable_sine(0)->set_amplitude_m(1, 0.034);
  expect_felt(400, 5000, pressed(scene, 6));
}

TEST(MediatedLoop, FeelsTheWallThroughABadNetwork) {
  for (const double wall : {200., 1000., 5000.})
    for (std::uint64_t seed = 1; seed <= 2; ++seed) {
      Scene scene = mediated_over(100, wall);
      worsen(scene, 10);
      scene.proto.set_seed(seed);
      expect_felt(100, wall, pressed(scene, 6));
    }
}

// The hand has done nothing that would pay for being pushed out of a wall it met too late: it is
// not pushed, and the robot does not press on for it.
TEST(MediatedLoop, PressesOnNothingThatTheHandIsNotAllowedToFeel) {
  for (const double wall : {1000., 5000.}) {
    const Pressing h = pressed(mediated_over(400, wall, false), 6);
    print(400, wall, h);
    EXPECT_EQ(h.violations, 0u);
    EXPECT_GE(h.operator_energy, -kEnergyStore) << wall;
    EXPECT_LT(h.chatter, 0.003) << wall;
    EXPECT_GT(h.contact, 1) << wall;
    EXPECT_LE(h.contact, h.force + 6) << wall;
  }
}

// The wall steps back or forth under the tool: how long until the hand feels the robot's force to
// within 1 N again, for good.
double right_after_step(double rtt, double wall, double by) {
  constexpr double kStep = kMoved + 5, kWatched = 4;
  Scene scene = mediated_over(rtt, wall);
  auto& step = *scene.proto.mutable_slave()->mutable_sim_arm()->mutable_surface(0)->add_step();
  step.set_at_s(kStep);
  for (const double x : {0., by, 0.}) step.add_by_m(x);
  Loopback loop(scene, {.duration_s = kStep + kWatched});
  Checkers checkers(loop);
  double contact = 0, given = 0, wrong = 0, most = 0, energy = 0, least = 0;
  std::optional<Vec3> last;
  Vec3 F_last = Vec3::Zero();
  loop.on_slave = [&](const SlaveTick& t) {
    checkers.check(t);
    contact = t.F_E_S.force.norm();
    given = std::max(given, t.out.wall.net);
  };
  loop.on_master = [&](const MasterTick& t) {
    checkers.check(t);
    const Vec3& p = t.handle.X_MH.p;
    if (last) energy -= F_last.dot(p - *last);
    last = p, F_last = t.handle.R_MG * t.F_G.force;
    least = std::min(least, energy);
    const double after = seconds(t.now - loop.start()) - kStep;
    if (after < 0) return;
    most = std::max(most, contact);
    if (std::abs(F_last.norm() - contact) > 1) wrong = after;
  };
  loop.run();
  std::printf(
      "%3.0f ms, %4.0f N/m stepped by %+.0f mm: felt to 1 N after %.2f s, robot presses %.1f N at "
      "most, operator's energy %.4f J of %.4f J that the wall gave\n",
      rtt, wall, by * 1e3, wrong, most, least, given);
  EXPECT_EQ(checkers.count(), 0u);
  EXPECT_GE(least, -kEnergyStore - given);
  return wrong;
}

TEST(MediatedLoop, FeelsAWallThatMovesSoonAfter) {
  for (const double wall : {200., 1000., 5000.})
    for (const double by : {0.008, -0.008}) EXPECT_LT(right_after_step(100, wall, by), 1.2) << wall;
}

Scene chosen_over(double rtt_ms, double wall) {
  Scene scene = pressing_over(rtt_ms, wall);
  scene.proto.mutable_compensation()->mutable_auto_();
  return scene;
}

// Pressed, left, and pressed again: the first time teaches the wall.
TEST(AutoLoop, ChoosesByDelayAndByWhatIsKnown) {
  for (const double rtt : {1., 100., 400.}) {
    Scene scene = chosen_over(rtt, 1000);
    proto::Motion& m = *hand(scene).mutable_motion();
    reach(m, kMoved + 3.5, 1, Vec3(0.04, 0, 0));
    reach(m, kMoved + 6.5, 1.5, Vec3(-0.04, 0, 0));
    const Pressing h = pressed(scene, 12);
    print(rtt, 1000, h);
    EXPECT_EQ(h.violations, 0u);
    EXPECT_EQ(h.method, rtt > 5 ? Method::mmt : Method::direct) << rtt;
    EXPECT_NEAR(h.stiffness / 1000, 1, 0.05) << rtt;
    EXPECT_LT(h.chatter, 0.003) << rtt;
  }
}

TEST(AutoLoop, LeavesDirectFeedbackThatRings) {
  const Pressing h = pressed(chosen_over(1, 5000), 6);
  print(1, 5000, h);
  EXPECT_EQ(h.violations, 0u);
  EXPECT_NE(h.method, Method::direct);
  EXPECT_GE(h.operator_energy, -kEnergyStore);
  EXPECT_LT(h.chatter, 0.003);
}

}  // namespace
}  // namespace farhand
