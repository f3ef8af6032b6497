// The Smith predictor in whole loops, for a robot and a wall that are known, and known wrongly.
#include <gtest/gtest.h>

#include "common/energy_budget.hpp"
#include "common/random.hpp"
#include "tests/loop/pressing.hpp"

namespace farhand::smith_test {
namespace {

Scene smith_over(double rtt_ms, double wall) {
  Scene scene = pressing_over(rtt_ms, wall);
  proto::SmithCompensation& s = *scene.proto.mutable_compensation()->mutable_smith();
  const proto::Surface& surface = scene.proto.slave().sim_arm().surface(0);
  proto::RegisteredWall& w = *s.mutable_wall();
  *w.mutable_point_in_slave_m() = surface.plane().point_m();
  for (const double n : surface.plane().normal()) w.add_normal_in_slave(-n);
  w.set_stiffness_newton_per_m(wall);
  // The arm's servo of 6 Hz, at the tool along this wall's normal.
  s.set_robot_mass_kg(4), s.set_servo_stiffness_newton_per_m(5800);
  s.set_servo_damping_newton_s_per_m(270);
  w.set_damping_newton_s_per_m(surface.damping_newton_s_per_m());
  return scene;
}

// stores: how many the hand may get out at most. One is what the guard allows; where a stiff wall
// rings by the servo's lag, or a wall drives the hand, what the guard asks for comes later by the
// force's slew limits.
Pressing run(double rtt, double wall, const Scene& scene, const char* what = "",
             double stores = 1) {
  const Pressing h = pressed(scene, 6);
  std::printf(
      "%3.0f ms, wall %4.0f N/m%s: felt %.3f of it, drag %.2f N, handle %.2f mm/s rms, robot "
      "presses "
      "%.1f N at most, operator's energy %.4f J\n",
      rtt, wall, what, h.stiffness / wall, h.drag, h.chatter * 1e3, h.peak_contact,
      h.operator_energy);
  EXPECT_EQ(h.violations, 0u);
  EXPECT_EQ(h.method, Method::smith);
  EXPECT_GE(h.operator_energy, -stores * kEnergyStore) << rtt << ' ' << wall;
  EXPECT_LT(h.chatter, 0.005) << rtt << ' ' << wall;
  return h;
}

TEST(SmithLoop, FeelsARegisteredWallAtAnyDelay) {
  for (const double rtt : {2., 20., 100.})
    for (const double wall : {200., 1000., 5000.}) {
      const Pressing h = run(rtt, wall, smith_over(rtt, wall), "", wall > 1000 ? 3 : 1);
      EXPECT_NEAR(h.stiffness / wall, 1, wall > 1000 ? 0.20 : 0.05) << rtt << ' ' << wall;
      EXPECT_LE(h.drag, 0.1) << rtt << ' ' << wall;
    }
}

// Each by up to a quarter either way, the wall 2 mm from where it is registered.
TEST(SmithLoop, FeelsTheWallWithAModelThatIsOff) {
  for (std::uint64_t seed = 1; seed <= 4; ++seed)
    for (const double wall : {200., 1000.}) {
      Random random(seed);
      const auto off = [&random] { return 0.75 + 0.5 * random.uniform(); };
      Scene scene = smith_over(100, wall);
      proto::SmithCompensation& s = *scene.proto.mutable_compensation()->mutable_smith();
      s.set_robot_mass_kg(off() * s.robot_mass_kg());
      s.set_servo_stiffness_newton_per_m(off() * s.servo_stiffness_newton_per_m());
      proto::RegisteredWall& w = *s.mutable_wall();
      w.set_stiffness_newton_per_m(off() * wall);
      w.set_point_in_slave_m(1, w.point_in_slave_m(1) + (seed % 2 == 0 ? 0.002 : -0.002));
      const Pressing h = run(100, wall, scene, ", model off");
      EXPECT_NEAR(h.stiffness / wall, 1, 0.05) << seed << ' ' << wall;
    }
}

// Back or forth under the tool, while what is registered stays where it was. One that comes may
// drive the hand by no more than the guard's store: what would go beyond is not felt.
TEST(SmithLoop, FollowsAWallThatMoves) {
  for (const double wall : {200., 1000.})
    for (const double by : {0.008, -0.008}) {
      Scene scene = smith_over(100, wall);
      auto& step = *scene.proto.mutable_slave()->mutable_sim_arm()->mutable_surface(0)->add_step();
      step.set_at_s(kMoved + 5);
      for (const double x : {0., by, 0.}) step.add_by_m(x);
      const Pressing h = run(100, wall, scene, by > 0 ? ", gives way" : ", comes", 2);
      EXPECT_LE(h.force, h.contact + 0.5) << wall << ' ' << by;
      EXPECT_GE(h.force, h.contact - (by > 0 ? 0.5 : 1.5)) << wall << ' ' << by;
    }
}

TEST(SmithLoop, StaysSafeOverABadNetwork) {
  for (const double wall : {200., 1000.}) {
    Scene scene = smith_over(100, wall);
    worsen(scene, 10);
    run(100, wall, scene, ", bad network");
  }
}

}  // namespace
}  // namespace farhand::smith_test
