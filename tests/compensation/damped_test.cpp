#include <gtest/gtest.h>

#include "tests/compensation/conditions.hpp"
#include "tests/compensation/methods.hpp"
#include "tests/compensation/task.hpp"
#include "tests/support/periodic.hpp"
#include "tests/support/stress.hpp"

namespace farhand::bench {
namespace {

TEST(SpringDamper, BothDampersTogetherExceedTheBound) {
  const DampedConfig c;
  for (const double T : {0.002, 0.01, 0.1, 0.4, 0.9}) {
    const SpringDamper s = spring_damper(c, T);
    EXPECT_GT(4 * s.B * s.B, T * T * s.K * s.K) << T;
    EXPECT_LE(s.B, c.max_damping * (1 + 1e-12));
  }
  EXPECT_EQ(spring_damper(c, 0.1).K, 400);
  EXPECT_NEAR(spring_damper(c, 0.1).B, 1.05 * 400 * 0.1 / 2, 1e-12);
  EXPECT_NEAR(spring_damper({.max_damping = 10}, 0.1).K, 10 / (1.05 * 0.1 / 2), 1e-9);
}

// The spring in series with the wall. The robot's servo (Kp 20 kN/m) gives way as well, and what
// the master is told is where the robot is: F = F_e (1 + K / Kp).
TEST(Damped, FeelsTheWallInSeriesWithTheSpring) {
  for (const double rtt : {0., 20., 100., 400.})
    for (const double k : kWalls)
      for (const double K : {400., 1500.}) {
        Damped method(DampedParts{.damped = {.stiffness = K, .max_damping = 400}});
        Rig s = plain(rtt).rig(k);
        s.hold = rtt * K > 1e5 ? 40 : kHold;  // [s] until it has settled
        const Figures f = run(s, method, rtt / 2e3);
        const double expected = K / (K + k), Kp = s.robot.Kp;
        const double exact = (1 + K / Kp) / k / (1 / k + 1 / K + 1 / Kp);
        EXPECT_NEAR(f.felt, exact, 0.003 * exact) << rtt << ' ' << k << ' ' << K;
        EXPECT_TRUE(K > 400 || std::abs(f.felt / expected - 1) < 0.02) << rtt << ' ' << k;
      }
}

struct Worst {
  double rmse = 0, drag = 0, chatter = 0, least = 0, guard_x = 0, guard_F = 0;
  long runs = 0, guarded = 0;
};

// With and without the guard, over every stride-th condition of a delay.
Worst worst(double rtt_ms, int stride) {
  Worst w;
  for (const Condition& c : conditions(rtt_ms, stride))
    for (const double k : kWalls) {
      Damped with, without(DampedParts{.guard = false});
      const Figures f = run(c.rig(k), with, c.T1()), off = run(c.rig(k), without, c.T1());
      EXPECT_TRUE(f.finite) << rtt_ms << ' ' << k << ' ' << c.name;
      EXPECT_LT(f.chatter, 0.005) << rtt_ms << ' ' << k << ' ' << c.name;
      w.rmse = std::max(w.rmse, f.rmse), w.drag = std::max(w.drag, f.drag);
      w.chatter = std::max(w.chatter, f.chatter), w.least = std::min(w.least, f.least);
      w.guard_x = std::max(w.guard_x, std::abs(f.rmse - off.rmse));
      w.guard_F = std::max({w.guard_F, std::abs(f.drag - off.drag), std::abs(f.force - off.force)});
      ++w.runs, w.guarded += with.acted() > 0;
    }
  std::printf(
      "%3.0f ms: %ld runs, robot within %.2f mm, drag %.2f N, chatter %.2f mm/s, least energy "
      "%.4f J; the guard acts in %ld, for %.4f mm, %.4f N\n",
      rtt_ms, w.runs, 1e3 * w.rmse, w.drag, 1e3 * w.chatter, w.least, w.guarded, 1e3 * w.guard_x,
      w.guard_F);
  return w;
}

TEST(Damped, StaysStableOverAllConditions) {
  const int stride = stress_ticks(0) > 0 ? 1 : 17;
  for (const double rtt : kRoundTrips) {
    const Worst w = worst(rtt, rtt == 100 ? std::min(stride, 6) : stride);
    EXPECT_LE(w.guard_x, 0.00005) << rtt;
    EXPECT_LE(w.guard_F, 0.05) << rtt;
    EXPECT_GE(w.least, -2 * kEnergyStore);
    if (rtt != 100) continue;
    EXPECT_LE(w.rmse, 0.0045);
    EXPECT_LE(w.drag, 3.5);
  }
}

TEST(DampedTouch, FeelsMoreForLessDragAndStaysStable) {
  const int stride = stress_ticks(0) > 0 ? 1 : 23;
  for (const double rtt : kRoundTrips) {
    double felt[3] = {2, 2, 2}, drag = 0, chatter = 0, rmse = 0, least = 0;
    for (const Condition& c : conditions(rtt, stride))
      for (int i = 0; i < 3; ++i) {
        Damped method(touching());
        const Figures f = run(c.rig(kWalls[i]), method, c.T1());
        EXPECT_TRUE(f.finite && f.chatter < 0.005) << rtt << ' ' << kWalls[i] << ' ' << c.name;
        felt[i] = std::min(felt[i], f.felt), rmse = std::max(rmse, f.rmse);
        drag = std::max(drag, f.drag), chatter = std::max(chatter, f.chatter);
        least = std::min(least, f.least);
      }
    std::printf(
        "%3.0f ms, touch: felt %.3f %.3f %.3f at least, drag %.2f N, robot within %.2f mm, "
        "chatter %.2f mm/s, least energy %.4f J\n",
        rtt, felt[0], felt[1], felt[2], drag, 1e3 * rmse, 1e3 * chatter, least);
    EXPECT_GE(least, -2 * kEnergyStore);
    if (rtt != 100) continue;
    EXPECT_GE(felt[1], 0.55);
    EXPECT_LE(drag, 1.6);
  }
}

TEST(DampedTouch, AMovingWallDoesNotShakeTheHand) {
  for (const double k : kWalls)
    for (const double hz : {0.3, 1., 2.}) {
      const Condition c = reference_condition();
      Rig rig = c.rig(k);
      rig.wall.x = [hz](double t) { return kWall + 0.005 * std::sin(kTurn * hz * t); };
      Damped method(touching());
      const Figures f = run(rig, method, c.T1());
      EXPECT_TRUE(f.finite);
      EXPECT_LT(f.peak_F, 12) << k << ' ' << hz;
      std::printf("%4.0f N/m moved at %.1f Hz: %.1f N at most, chatter %.2f mm/s\n", k, hz,
                  f.peak_F, 1e3 * f.chatter);
    }
}

// What must be seen if the damping were too small.
TEST(Damped, DivergesWithAFiftiethOfTheDamping) {
  for (const double share : {0.5, 0.02}) {
    Damped method(DampedParts{.damped = {.margin = 1.05 * share}, .guard = false});
    const Figures f = run(plain(100).rig(1000), method, 0.05);
    EXPECT_EQ(f.finite && f.chatter < 0.005, share == 0.5) << share;
  }
}

}  // namespace
}  // namespace farhand::bench
