#include <gtest/gtest.h>

#include "tests/compensation/conditions.hpp"
#include "tests/compensation/methods.hpp"
#include "tests/compensation/task.hpp"
#include "tests/support/periodic.hpp"
#include "tests/support/stress.hpp"

namespace farhand::bench {
namespace {

const Vec3 kNormal = Vec3(1, -2, 2) / 3;

LocalWall wall(double k = 1000) {
  return {.known = true, .x_w = Vec3(0.1, 0, 0), .n = kNormal, .k = k, .contacts = 1};
}

constexpr OperatorAllowance kAll{.share = 1, .energy = 1};

TEST(WallRenderer, BeginsWhereTheHandIsAndAgreesLinearly) {
  WallRenderer r({.agree_time = 0.15, .drag = 0});
  const Vec3 x = wall().x_w + 0.01 * kNormal + 0.3 * kNormal.cross(Vec3::UnitX());
  const Vec3 first = r.step(x, Vec3::Zero(), wall(), kAll);
  EXPECT_LT(first.norm(), 0.1);  // a tick of agreement
  Vec3 F = first;
  for (int i = 1; i < 150; ++i) F = r.step(x, Vec3::Zero(), wall(), kAll);
  EXPECT_NEAR(F.norm(), 10 * (1 - std::exp(-1)), 0.1);
  for (int i = 0; i < 2000; ++i) F = r.step(x, Vec3::Zero(), wall(), kAll);
  EXPECT_NEAR((F - 10 * kNormal).norm(), 0, 0.001);
}

TEST(WallRenderer, ChangesItsStiffnessAtConstantForce) {
  WallRenderer r({.agree_time = 1e9, .drag = 0});
  Vec3 x = wall().x_w;
  r.step(x, Vec3::Zero(), wall(), kAll);
  x += 0.005 * kNormal;
  EXPECT_NEAR(r.step(x, Vec3::Zero(), wall(), kAll).norm(), 5, 1e-9);
  EXPECT_NEAR(r.step(x, Vec3::Zero(), wall(4000), kAll).norm(), 5, 1e-9);
  EXPECT_NEAR(r.wall().k, 1020, 1e-9);
  for (int i = 0; i < 100; ++i) r.step(x, Vec3::Zero(), wall(4000), kAll);
  EXPECT_NEAR(r.step(x + 0.001 * kNormal, Vec3::Zero(), wall(4000), kAll).norm(), 9, 1e-6);
}

// 1 mJ pays for a force of which a quarter of the spring's energy is so much; more comes with more,
// and what is there stays when there is less.
TEST(WallRenderer, ComesAsFarAsTheTankPaysFor) {
  WallRenderer r({.drag = 0});
  const Vec3 x = wall().x_w + 0.01 * kNormal;
  const auto felt = [&](double energy) {
    Vec3 F;
    for (int i = 0; i < 2000; ++i) F = r.step(x, Vec3::Zero(), wall(), {1, energy});
    return F.norm();
  };
  EXPECT_NEAR(felt(0), 0, 1e-9);
  EXPECT_NEAR(felt(0.001), std::sqrt(2 * 0.001 * 1000 / 0.25), 1e-6);
  EXPECT_NEAR(felt(0.004), std::sqrt(2 * 0.004 * 1000 / 0.25), 1e-6);
  EXPECT_NEAR(felt(0), std::sqrt(2 * 0.004 * 1000 / 0.25), 1e-6);
  EXPECT_NEAR(felt(1), 10, 0.001);
}

// The floor, then a side wall a long way off; and the floor again with friction turning the normal.
TEST(WallRenderer, AnotherWallBeginsWhereTheHandIs) {
  const std::pair<Vec3, double> cases[] = {{Vec3::UnitX(), 0.5}, {Vec3(0.28, 0, -0.96), 4}};
  for (const auto& [n, most] : cases) {  // [N]; of the floor the hand knew already
    WallRenderer r({.drag = 0});
    LocalWall told{.known = true, .n = -Vec3::UnitZ(), .k = 1000, .contacts = 1};
    for (int i = 0; i < 500; ++i) r.step(Vec3(0, 0, -0.005), Vec3::Zero(), told, kAll);
    const Vec3 away(0.2, 0, 0.001);
    for (int i = 0; i < 100; ++i) r.step(away, Vec3::Zero(), told, kAll);
    told.n = n, told.x_w = away, told.contacts = 2;
    EXPECT_LT(r.step(away + 0.005 * n, Vec3::Zero(), told, kAll).norm(), most) << n.transpose();
    Vec3 F;
    for (int i = 0; i < 2000; ++i) F = r.step(away + 0.005 * n, Vec3::Zero(), told, kAll);
    EXPECT_NEAR((F - 5 * n).norm(), 0, 0.01) << n.transpose();
  }
}

// The same wall, touched elsewhere: its plane goes through where it is touched now.
TEST(WallFinder, SlidesAlongItsWall) {
  WallFinder f({});
  const auto press = [&f](const Vec3& at, const Vec3& n) {
    for (int i = 0; i < 300; ++i) {
      const double in = 0.003 * i / 300, v = 0.01;
      const Vec3 x = at + in * n;
      f.step(x, 5 * n, x, x, v * n, 1000 * in * n);
    }
  };
  press(Vec3::Zero(), Vec3::UnitZ());
  const Vec3 there(0.1, 0, 0), n = Vec3(0.28, 0, 0.96);
  press(there, n);
  EXPECT_LT(std::abs((f.wall().x_w - there).dot(n)), 0.001);
  EXPECT_EQ(f.wall().contacts, 2u);
}

TEST(WallRenderer, NeverPullsAndFadesWhenTheWallIsGone) {
  WallRenderer r({.drag = 0});
  const Vec3 x = wall().x_w + 0.01 * kNormal;
  for (int i = 0; i < 2000; ++i) r.step(x, Vec3::Zero(), wall(), kAll);
  EXPECT_EQ(r.step(wall().x_w - 0.01 * kNormal, Vec3::Zero(), wall(), kAll), Vec3::Zero());
  EXPECT_NEAR(r.step(x, Vec3::Zero(), {}, kAll).norm(), 10, 0.1);
  for (int i = 0; i < 150; ++i) r.step(x, Vec3::Zero(), {}, kAll);
  EXPECT_NEAR(r.step(x, Vec3::Zero(), {}, kAll).norm(), 10 * std::exp(-1), 0.1);
  for (int i = 0; i < 2000; ++i) r.step(x, Vec3::Zero(), {}, kAll);
  EXPECT_FALSE(r.wall().known);
}

// Messages that lie: a wall that jumps into the hand and away again, with nothing behind it.
TEST(OperatorTank, GivesOutNoMoreThanTheStoreWhateverIsTold) {
  WallRenderer r({.agree_time = 0.01, .drag = 0});
  OperatorTank tank({});
  double x = 0, v = 0, given = 0, most = 0;
  Vec3 F = Vec3::Zero();
  for (int i = 0; i < 20000; ++i) {
    LocalWall told{.known = true, .n = Vec3::UnitZ(), .k = 1000, .contacts = 1};
    told.x_w.z() = i / 200 % 2 == 0 ? -0.02 : 0.05;
    const OperatorAllowance allowed = tank.step(F, Vec3(0, 0, x), 0, 1);
    F = r.step(Vec3(0, 0, x), Vec3(0, 0, v), told, allowed);
    v += 0.001 / 0.5 * (100 * (0.01 - x) - 2 * v - F.z());
    x += 0.001 * v;
    given -= F.z() * 0.001 * v;
    most = std::max(most, given);
  }
  std::printf("lying wall: %.4f J given at most\n", most);
  EXPECT_GT(most, 0.005);
  EXPECT_LE(most, kEnergyStore);
}

TEST(OperatorTank, AMovingWallIsPaidForAndSettled) {
  OperatorTank tank({.start = 0.02, .cap = 0.2, .low = 0.01});
  const Vec3 F(0, 0, 10);
  EXPECT_EQ(tank.step(F, Vec3::Zero(), 0, 1).share, 1);
  EXPECT_EQ(tank.step(F, Vec3(0, 0, -0.01), 0.2, 1).share, 1);  // 0.1 J out, 0.2 J told
  EXPECT_NEAR(tank.held(), -0.08, 1e-12);
  EXPECT_EQ(tank.step(Vec3::Zero(), Vec3::Zero(), 0, 2).share, 0);  // the next contact owes nothing
  EXPECT_NEAR(tank.held(), 0, 1e-12);
  for (int i = 0; i < 100; ++i) tank.step(F, Vec3(0, 0, 0.01 * i), 0, 2);
  EXPECT_NEAR(tank.held(), 0.2, 1e-12);
}

Figures mediated(const Condition& c, const Rig& rig, const MediatedParts& parts = {}) {
  Mediated m(parts);
  return run(rig, m, c.T1());
}

TEST(Mediated, FeelsTheWallAtEveryDelay) {
  for (const double rtt : {20., 100., 200., 400.})
    for (const double k : kWalls) {
      const Condition c = reference_condition(rtt);
      const Figures f = mediated(c, c.rig(k));
      EXPECT_GE(f.felt, k > 1000 ? 0.75 : 0.90) << rtt << ' ' << k;
      EXPECT_LE(f.drag, 0.8) << rtt << ' ' << k;
      EXPECT_LT(f.chatter, 0.003) << rtt << ' ' << k;
      EXPECT_GE(f.operator_least, -kEnergyStore) << rtt << ' ' << k;
      EXPECT_LE(f.peak_F_e, 25) << rtt << ' ' << k;
      std::printf(
          "%3.0f ms, %4.0f N/m: felt %.3f, drag %.2f N, chatter %.2f mm/s, robot presses "
          "%.1f N at most\n",
          rtt, k, f.felt, f.drag, 1e3 * f.chatter, f.peak_F_e);
    }
}

TEST(Mediated, StaysStableOverAllConditions) {
  const int stride = stress_ticks(0) > 0 ? 1 : 17;
  double chatter = 0, drag = 0, peak = 0, felt[3] = {2, 2, 2}, least = 0;
  long runs = 0;
  for (const double rtt : kRoundTrips)
    for (const Condition& c : conditions(rtt, stride))
      for (int i = 0; i < 3; ++i, ++runs) {
        const Figures f = mediated(c, c.rig(kWalls[i]));
        EXPECT_TRUE(f.finite && f.chatter < 0.005) << rtt << ' ' << kWalls[i] << ' ' << c.name;
        chatter = std::max(chatter, f.chatter), drag = std::max(drag, f.drag);
        felt[i] = std::min(felt[i], f.felt), peak = std::max(peak, f.peak_F_e);
        least = std::min(least, f.operator_least);
      }
  std::printf(
      "%ld runs: felt %.3f %.3f %.3f at least, drag %.2f N, chatter %.2f mm/s, robot "
      "presses %.1f N, operator's energy %.4f J\n",
      runs, felt[0], felt[1], felt[2], drag, 1e3 * chatter, peak, least);
  EXPECT_GE(least, -kEnergyStore);
}

TEST(Mediated, StaysStableWithAWrongModelAndOtherHands) {
  double worst = 0;
  for (const double rtt : {100., 400.})
    for (const double k : kWalls) {
      const Condition c = reference_condition(rtt);
      const auto check = [&](const Rig& rig, double error) {
        const Figures f =
            mediated(c, rig, {.finder = {.bias = 1.1 * error, .max_stiffness = 16000}});
        EXPECT_TRUE(f.finite && f.chatter < 0.005) << rtt << ' ' << k << ' ' << error;
        worst = std::max(worst, f.chatter);
      };
      for (const double error : {0.5, 0.75, 1.25, 2., 4.}) check(c.rig(k), error);
      for (const double hand : {100., 1500.}) {
        Rig rig = c.rig(k);
        rig.hand.k = hand;
        for (const double b : {0., 50.}) rig.wall.b = b, check(rig, 1);
      }
    }
  std::printf("wrong models and other hands: chatter %.2f mm/s\n", 1e3 * worst);
}

TEST(Mediated, AgreesWithAWallThatStepped) {
  for (const double k : kWalls)
    for (const double step : {0.008, -0.008}) {
      const Condition c = reference_condition();
      Rig rig = c.rig(k);
      rig.hold = 6;
      rig.wall.x = [step](double t) { return kWall + (t > 8 ? step : 0); };
      Mediated m;
      double after = 0;
      run(rig, m, c.T1(), [&](const Sample& a) {
        if (a.t > 8 && a.t < 12 && std::abs(a.F - a.F_e) >= 1) after = a.t - 8;
      });
      EXPECT_LT(after, 1.2) << k << ' ' << step;
      std::printf("%4.0f N/m stepped by %+.0f mm: less than 1 N off after %.2f s\n", k, 1e3 * step,
                  after);
    }
}

TEST(Mediated, AMovingWallDoesNotShakeTheHandAndTakesLeave) {
  for (const double k : kWalls)
    for (const double hz : {0.3, 1., 2.}) {
      const Condition c = reference_condition();
      Rig rig = c.rig(k);
      rig.wall.x = [hz](double t) { return kWall + 0.005 * std::sin(kTurn * hz * t); };
      const Figures f = mediated(c, rig);
      EXPECT_TRUE(f.finite);
      EXPECT_LT(f.peak_F, 10) << k << ' ' << hz;  // a still wall: 5.8 N
      EXPECT_LT(f.lag, 0.001) << k << ' ' << hz;  // no ghost of it at the end
    }
}

}  // namespace
}  // namespace farhand::bench
