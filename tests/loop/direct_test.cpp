// Direct feedback under its guards in whole loops: as good as none at all over a fast network, and
// bounded where it rings.
#include <gtest/gtest.h>

#include "common/energy_budget.hpp"
#include "tests/loop/pressing.hpp"

namespace farhand {
namespace {

Scene direct_over(double rtt_ms, double wall) {
  Scene scene = pressing_over(rtt_ms, wall);
  scene.proto.mutable_compensation()->mutable_direct();
  return scene;
}

Pressing run(double rtt, double wall, const Scene& scene) {
  const Pressing h = pressed(scene, 6);
  std::printf(
      "%3.0f ms, wall %4.0f N/m: felt %.3f of it, drag %.2f N, handle %.2f mm/s rms, robot presses "
      "%.1f N at most, operator's energy %.4f J\n",
      rtt, wall, h.stiffness / wall, h.drag, h.chatter * 1e3, h.peak_contact, h.operator_energy);
  EXPECT_EQ(h.violations, 0u);
  EXPECT_EQ(h.method, Method::direct);
  EXPECT_GE(h.operator_energy, -2 * kEnergyStore) << rtt << ' ' << wall;
  EXPECT_LT(h.chatter, 0.005) << rtt << ' ' << wall;
  return h;
}

TEST(DirectLoop, FeelsTheWallWhereItDoesNotRing) {
  for (const auto& [rtt, wall] : {std::pair{2., 200.}, {2., 1000.}, {20., 200.}}) {
    const Pressing h = run(rtt, wall, direct_over(rtt, wall));
    EXPECT_NEAR(h.stiffness / wall, 1, 0.05) << rtt << ' ' << wall;
    EXPECT_LE(h.drag, 0.1) << rtt << ' ' << wall;
  }
}

// Pressed and left again and again: the robot's lag costs the hand's guard something each time,
// and it gets it back.
TEST(DirectLoop, FeelsTheWallAfterManyWithdrawals) {
  Scene scene = direct_over(2, 1000);
  proto::Motion& m = *hand(scene).mutable_motion();
  for (int i = 0; i < 6; ++i) {
    reach(m, kMoved + 3 + 3 * i, 1, Vec3(0.04, 0, 0));
    reach(m, kMoved + 4.5 + 3 * i, 1, Vec3(-0.04, 0, 0));
  }
  const Pressing h = pressed(scene, 20);
  std::printf("after six withdrawals: felt %.3f of it, handle %.2f mm/s rms\n", h.stiffness / 1000,
              h.chatter * 1e3);
  EXPECT_EQ(h.violations, 0u);
  EXPECT_NEAR(h.stiffness / 1000, 1, 0.05);
  EXPECT_LT(h.chatter, 0.003);
}

// Beyond B_h / ke of round trip.
TEST(DirectLoop, IsHeldByItsGuardsWhereItRings) {
  for (const auto& [rtt, wall] : {std::pair{2., 5000.},
                                  {20., 1000.},
                                  {20., 5000.},
                                  {100., 200.},
                                  {100., 1000.},
                                  {100., 5000.}})
    run(rtt, wall, direct_over(rtt, wall));
}

TEST(DirectLoop, IsBoundedOverABadNetwork) {
  for (const double wall : {200., 1000., 5000.}) {
    Scene scene = direct_over(20, wall);
    worsen(scene, 5);
    run(20, wall, scene);
  }
}

}  // namespace
}  // namespace farhand
