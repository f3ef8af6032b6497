#include <gtest/gtest.h>

#include <memory>

#include "tests/compensation/conditions.hpp"
#include "tests/compensation/methods.hpp"
#include "tests/compensation/task.hpp"

namespace farhand::bench {
namespace {

constexpr double kRounding = 1e-9;  // [J] of sums over some 10^4 ticks

// The hand pulled along at 0.1 m/s by a force that has no energy behind it.
TEST(ForceGuard, GivesOutTheStoreAndNoMore) {
  ForceGuard guard({.store = 0.02, .reserve = 0.005});
  double given = 0, F = 0;
  for (int i = 0; i < 2000; ++i) {
    given -= F * 0.1e-3;
    F = guard.step(Vec3(0, 0, -5), Vec3(0, 0, 0.1e-3 * i)).z();
  }
  EXPECT_NEAR(given, 0.015, 2 * 5 * 0.1e-3);  // the first two ticks do not know the speed
  EXPECT_TRUE(guard.acting());
  EXPECT_NEAR(F, 0, kRounding);
}

TEST(ForceGuard, LeavesAForceThatResistsAlone) {
  ForceGuard guard({.store = 0.001, .reserve = 0.001});
  const Vec3 F(1, 2, -3), v(0.2, 0, -0.1);
  for (int i = 0; i < 100; ++i) EXPECT_EQ(guard.step(F, 0.001 * i * v), F);
  EXPECT_NEAR(guard.budget().in(), 99 * 0.001 * F.dot(v), 1e-12);
}

// The hand turns round as nothing foretold.
TEST(ForceGuard, PaysBackWhatItDidNotForesee) {
  ForceGuard guard({.store = 0.1, .reserve = 0.1, .max_damping = 50});
  const Vec3 F(0, 0, 10);
  for (const double x : {0., 0.0001, 0.0002, 0.0001}) guard.step(F, Vec3(0, 0, x));
  EXPECT_NEAR(guard.budget().left(), -0.001, 1e-12);
  int ticks = 0;
  for (double x = 0.0001; guard.budget().left() < -kRounding && ticks < 100; ++ticks)
    EXPECT_LE(guard.step(F, Vec3(0, 0, x += 0.0001)).z(), 10 + 50 * 0.3 + 1e-9);
  EXPECT_LE(ticks, 6);  // 50 N s/m at 0.1 m/s take 0.5 W
}

TEST(VelocityGuard, TheRobotStopsWhereItsEnergyEnds) {
  VelocityGuard guard({.store = 0.02});
  const Vec3 F(0, 0, 4), v(0.05, 0, 0.1);
  double given = 0;
  for (int i = 0; i < 200; ++i) given += 0.001 * guard.step(v, Vec3::Zero(), F).dot(F);
  EXPECT_NEAR(given, 0.02, kRounding);
  EXPECT_EQ(guard.step(v, Vec3::Zero(), F), Vec3(0.05, 0, 0));  // across the force it may move
  EXPECT_EQ(guard.step(-v, Vec3::Zero(), F), Vec3(-v));
  EXPECT_NEAR(guard.budget().left(), 0.001 * 0.4, kRounding);  // kept to be given out here again
}

TEST(VelocityGuard, TakesDriftBackOnlyFromASurplus) {
  VelocityGuard guard({.store = 0, .drift_time = 0.05, .drift_speed = 0.05});
  const Vec3 drift(0, 0, 0.001), F(0, 0, 1);
  EXPECT_EQ(guard.step(Vec3::Zero(), drift, Vec3::Zero()), Vec3(0, 0, 0.02));
  EXPECT_EQ(guard.step(Vec3::Zero(), 100 * drift, Vec3::Zero()), Vec3(0, 0, 0.05));
  EXPECT_EQ(guard.step(Vec3::Zero(), drift, F), Vec3::Zero());
  guard.budget().receive(10e-6);
  EXPECT_NEAR(guard.step(Vec3::Zero(), drift, F).z(), 0.01, 1e-12);
  EXPECT_NEAR(guard.budget().left(), 0, 1e-15);
}

TEST(VelocityGuard, GoesByNoForceThatIsNoise) {
  VelocityGuard guard({.store = 0, .drift_time = 0.05, .drift_speed = 0.05, .noise = 0.25});
  const Vec3 v(0.03, 0, 0.1), off(0, 0, 0.001), moved = 0.001 * v;
  for (const double f : {-0.25, -0.1, 0.1, 0.25})
    EXPECT_LT((guard.step(v, off, Vec3(0, 0, f), moved) - Vec3(0.03, 0, 0.12)).norm(), 1e-12) << f;
  EXPECT_EQ(guard.budget().left(), 0);
  EXPECT_NEAR(guard.step(v, off, Vec3(0, 0, 0.3), moved).z(), 0, 1e-12);
  EXPECT_NEAR(guard.budget().out(), 0.05 * moved.z(), 1e-12);
}

std::vector<std::unique_ptr<Guarded>> guarded_methods() {
  std::vector<std::unique_ptr<Guarded>> out;
  out.push_back(std::make_unique<Damped>());
  out.push_back(std::make_unique<Direct>(1, true));
  out.push_back(std::make_unique<Direct>(0.3, true));
  return out;
}

// Direct feedback gives out energy without bounds; under the guard no more than both stores.
TEST(Guard, BoundsTheEnergyInEveryImpairment) {
  double least = 0, unguarded = 0;
  for (const double rtt : {20., 100., 400.})
    for (const Condition& c : conditions(rtt, 19))
      for (const double k : kWalls) {
        for (const auto& m : guarded_methods()) {
          const Figures f = run(c.rig(k), *m, c.T1());
          least = std::min(least, f.least);
          EXPECT_GE(f.least, -2 * kEnergyStore) << rtt << ' ' << k << ' ' << c.name;
        }
        Direct off(1, false);
        unguarded = std::min(unguarded, run(c.rig(k), off, c.T1()).least);
      }
  std::printf("least energy %.5f J, direct without a guard %.3f J\n", least, unguarded);
  EXPECT_LT(unguarded, -1);
}

// To the last bit: sums and the newest message do not change by hearing them twice.
TEST(Guard, ResultsAreTheSameWithEveryDatagramTwice) {
  for (std::size_t i = 0; i < guarded_methods().size(); ++i) {
    std::vector<double> once, twice;
    for (std::vector<double>* out : {&once, &twice}) {
      const auto m = std::move(guarded_methods()[i]);
      Rig s = reference_condition().rig(1000);
      s.twice = out == &twice;
      run(s, *m, 0.05, [&](const Sample& a) { out->insert(out->end(), {a.x_s, a.F, a.energy}); });
    }
    EXPECT_EQ(once, twice) << i;
  }
}

// Losses end in the hold: soon after, the energies and all that is felt are those of a run that
// never lost a thing.
TEST(Guard, ConvergesAfterLosses) {
  const auto final_state = [](const Condition& c) {
    Rig s = c.rig(1000);
    s.plain_from = kFree + kRamp + 1;
    Damped m;
    Sample last;
    run(s, m, 0.05, [&](const Sample& a) {
      if (a.t < kFree + kRamp + kHold) last = a;
    });
    return last;
  };
  Condition lossy = plain(100);
  bursts(lossy, 0.2 * 10 / 90);
  const Sample a = final_state(lossy), b = final_state(plain(100));
  EXPECT_NEAR(a.x_s, b.x_s, 1e-5);
  EXPECT_NEAR(a.x_m, b.x_m, 1e-5);
  EXPECT_NEAR(a.F, b.F, 0.005);
}

}  // namespace
}  // namespace farhand::bench
