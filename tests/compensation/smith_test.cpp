#include <gtest/gtest.h>

#include "tests/compensation/conditions.hpp"
#include "tests/compensation/methods.hpp"
#include "tests/compensation/task.hpp"

namespace farhand::bench {
namespace {

Figures predicted(const Condition& c, const Rig& rig, double error = 1) {
  SmithConfig config;
  config.wall = {
      .known = true, .x_w = along(kWall), .n = along(1), .k = error * rig.wall.k, .b = 5};
  Smith method(config);
  return run(rig, method, c.T1());
}

// The model is 25 % and 50 % off; the wall of 5000 N/m rings by the servo's lag alone, under the
// guard.
TEST(Smith, FeelsTheWallAtEveryDelayWithAModelThatIsOff) {
  for (const double rtt : {20., 100., 400.})
    for (const double k : kWalls)
      for (const double error : {0.5, 0.75, 1., 1.25}) {
        const Condition c = reference_condition(rtt);
        const Figures f = predicted(c, c.rig(k), error);
        EXPECT_TRUE(f.finite);
        EXPECT_GE(f.operator_least, -kEnergyStore) << rtt << ' ' << k << ' ' << error;
        EXPECT_LT(f.chatter, 0.005) << rtt << ' ' << k << ' ' << error;
        EXPECT_GE(f.felt, k > 1000 ? 0.2 : 0.93) << rtt << ' ' << k << ' ' << error;
        if (error == 1)
          std::printf("%3.0f ms, %4.0f N/m: felt %.3f, drag %.2f N, chatter %.2f mm/s\n", rtt, k,
                      f.felt, f.drag, 1e3 * f.chatter);
      }
}

TEST(Smith, GivesOutNoEnergyWhateverTheWallDoes) {
  for (const double rtt : {20., 100., 400.})
    for (const double k : kWalls)
      for (const double step : {0.008, -0.008}) {
        const Condition c = reference_condition(rtt);
        Rig rig = c.rig(k);
        rig.wall.x = [step](double t) { return kWall + (t > 8 ? step : 0); };
        const Figures f = predicted(c, rig);
        EXPECT_TRUE(f.finite);
        EXPECT_GE(f.operator_least, -kEnergyStore) << rtt << ' ' << k << ' ' << step;
      }
}

}  // namespace
}  // namespace farhand::bench
