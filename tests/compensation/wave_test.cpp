#include <gtest/gtest.h>

#include "tests/compensation/conditions.hpp"
#include "tests/compensation/methods.hpp"
#include "tests/compensation/task.hpp"

namespace farhand::bench {
namespace {

// T: one way, the reconstruction and the playout. The servo and the virtual spring give way too.
TEST(Wave, FeelsTheWallInSeriesWithTheNetwork) {
  for (const double rtt : {20., 50., 200.})
    for (const double k : kWalls)
      for (const double b : {20., 100.}) {
        WaveConfig c;
        c.b = b;
        Wave method(c);
        Rig rig = plain(rtt).rig(k);
        rig.robot = {.Kp = 200000, .Kd = 1265};  // as stiff as the equation thinks it
        rig.hold = 8;
        const Figures f = run(rig, method, rtt / 2e3);
        const double T = rtt / 2e3 + c.tau + method.playout();
        const double expected = 1 / (1 + k * T / b);
        const double exact = 1 / (1 + k * (T / b + 1 / Wave::kStiffness + 1 / rig.robot.Kp));
        EXPECT_NEAR(f.felt, exact, 0.06 * exact) << rtt << ' ' << k << ' ' << b;
        EXPECT_TRUE(b > 20 || std::abs(f.felt / expected - 1) < 0.1) << rtt << ' ' << k;
        EXPECT_LT(f.chatter, 0.005);
        if (k == 1000)
          std::printf("%3.0f ms, b %3.0f: felt %.3f (%.3f), drag %.2f N, robot within %.2f mm\n",
                      rtt, b, f.felt, expected, f.drag, 1e3 * f.rmse);
      }
}

TEST(Wave, GivesOutNoEnergyInAnyImpairment) {
  double least = 0, chatter = 0;
  for (const double rtt : kRoundTrips)
    for (const Condition& c : conditions(rtt, rtt == 100 ? 13 : 31))
      for (const double k : kWalls) {
        Wave method({});
        const Figures f = run(c.rig(k), method, c.T1());
        EXPECT_TRUE(f.finite) << rtt << ' ' << k << ' ' << c.name;
        EXPECT_GE(f.least, -2 * kEnergyStore) << rtt << ' ' << k << ' ' << c.name;
        least = std::min(least, f.least), chatter = std::max(chatter, f.chatter);
      }
  std::printf("least energy %.5f J, chatter %.2f mm/s\n", least, 1e3 * chatter);
}

TEST(Wave, ResultsAreTheSameWithEveryDatagramTwice) {
  std::vector<double> once, twice;
  for (std::vector<double>* out : {&once, &twice}) {
    Wave method({});
    Rig rig = plain(100).rig(1000);
    rig.twice = out == &twice;
    run(rig, method, 0.05, [&](const Sample& a) { out->insert(out->end(), {a.x_s, a.F}); });
  }
  double most = 0;
  for (std::size_t i = 0; i < once.size(); ++i) most = std::max(most, std::abs(once[i] - twice[i]));
  EXPECT_EQ(once, twice) << most;
}

TEST(Wave, KeepsThePositionOverLosses) {
  Condition c = plain(50);
  bursts(c, 0.2 * 10 / 90);
  Rig rig = c.rig(200);
  rig.wall.x = [](double) { return 1; };  // none
  rig.plain_from = 10;
  rig.hold = 6;
  Wave method({});
  EXPECT_LT(run(rig, method, c.T1()).lag, 0.002);
}

}  // namespace
}  // namespace farhand::bench
