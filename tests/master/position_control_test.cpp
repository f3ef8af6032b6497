#include "master/position_control.hpp"

#include <gtest/gtest.h>

namespace farhand {
namespace {

using std::chrono::milliseconds;

TEST(PositionControl, HoldsTheGripWhereItWasSwitchedOnAndCarriesItsWeight) {
  PositionControl control({}, 0.01);
  LimitSet set = 0;
  const Vec3 p(0.01, 0.02, 0.12);
  EXPECT_NEAR((control.step(TimePoint{}, {.p_MH = p}, set) - Vec3(0, 0.3 * 9.81, 0)).norm(), 0,
              1e-15);
  EXPECT_EQ(control.target(), p);
  EXPECT_EQ(set, kLimitNone);
}

TEST(PositionControl, TakesItsSetPointsInTimeCountedFromTheFirstSample) {
  const Vec3 a(0.01, 0, 0.12), b(0, 0.01, 0.12);
  PositionControl control({.set_points = {{milliseconds(100), a}, {milliseconds(200), b}}}, 0.01);
  const TimePoint start{std::chrono::hours(5)};
  LimitSet set = 0;
  control.step(start, {.p_MH = Vec3(0, 0, 0.12)}, set);
  EXPECT_EQ(control.target(), Vec3(0, 0, 0.12));
  control.step(start + milliseconds(100), {.p_MH = Vec3(0, 0, 0.12)}, set);
  EXPECT_EQ(control.target(), a);
  control.step(start + milliseconds(500), {.p_MH = Vec3(0, 0, 0.12)}, set);
  EXPECT_EQ(control.target(), b);
}

TEST(PositionControl, ForceIsCappedInItsDirection) {
  PositionControl control({.pid = {.kp = 1000}, .max_force = 5, .gravity_mass = 0}, 0.01);
  LimitSet set = 0;
  control.step(TimePoint{}, {}, set);
  const Vec3 f = control.step(TimePoint{}, {.p_MH = Vec3(-0.03, 0.04, 0)}, set);
  EXPECT_NEAR((f - Vec3(3, -4, 0)).norm(), 0, 1e-14);
  EXPECT_TRUE(set & kLimitForce);
}

// A light grip that hardly brakes itself, and a hand's push on it; semi-implicit Euler at 1 kHz.
struct Plant {
  explicit Plant(const PositionControlConfig& config) : control(config, Ts) {}

  Vec3 tick(const Vec3& push = Vec3::Zero(), bool park = false, const Vec3& danger = Vec3::Zero()) {
    constexpr double kMass = 0.3, kDamping = 1;
    const Vec3 f = control.step(now, {p, v, park, danger}, set);
    now += milliseconds(1);
    v += Ts / kMass * (f + push - kDamping * v - Vec3(0, kMass * 9.81, 0));
    p += Ts * v;
    biggest_step = std::max(biggest_step, (f - last).norm());
    last = f;
    return f;
  }

  static constexpr double Ts = 0.001;
  PositionControl control;
  Vec3 p = Vec3(0, 0, 0.12), v = Vec3::Zero(), last = Vec3::Zero();
  TimePoint now{};
  LimitSet set = 0;
  double biggest_step = 0;
};

PositionControlConfig safe_config() {
  PositionControlConfig c;
  c.safe.emplace();
  return c;
}

TEST(PositionControl, InSafeMotionTheGripTravelsNoFasterThanAllowed) {
  PositionControlConfig config = safe_config();
  const Vec3 goal(0.03, -0.02, 0.1);
  config.set_points = {{milliseconds(100), goal}};
  Plant plant(config);
  for (int k = 0; k < 100; ++k) plant.tick();  // the force comes up from nothing
  plant.biggest_step = 0;
  double fastest = 0;
  for (int k = 0; k < 4000; ++k) {
    plant.tick();
    fastest = std::max(fastest, plant.v.norm());
  }
  EXPECT_LE(fastest, 0.1);
  EXPECT_GT(fastest, 0.03);
  EXPECT_NEAR((plant.p - goal).norm(), 0, 5e-4);
  EXPECT_LE(plant.biggest_step, 0.05) << "the target travels: no jump of the force";
}

// Pushed 60 mm away within half a second, held there for five, and let go.
TEST(PositionControl, AHandPushesTheGripThroughAtTheCapAndItComesBackAtTheSafeSpeed) {
  const PositionControlConfig config = safe_config();
  Plant plant(config);
  for (int k = 0; k < 200; ++k) plant.tick();
  const Vec3 home = plant.p, away = home + Vec3(0.06, 0, 0);
  double strongest = 0;
  for (int k = 0; k < 5500; ++k) {
    plant.p = home + std::min(1.0, k / 500.0) * (away - home);
    plant.v = k < 500 ? Vec3(0.12, 0, 0) : Vec3::Zero();
    strongest = std::max(strongest, plant.tick().norm());
    plant.v.setZero();
  }
  const double drive = config.max_force - 0.3 * 9.81;
  EXPECT_LE(strongest, config.max_force + 1e-12);
  EXPECT_NEAR(plant.last.x(), -drive, 1e-3) << "held at the cap";
  plant.p = away;
  double fastest = 0, beyond = 0;
  for (int k = 0; k < 6000; ++k) {
    plant.tick();
    fastest = std::max(fastest, plant.v.norm());
    beyond = std::max(beyond, home.x() - plant.p.x());
  }
  EXPECT_LE(fastest, 0.1);
  EXPECT_GT(fastest, 0.08);
  EXPECT_LE(beyond, 5e-4) << "wound up";
  EXPECT_NEAR((plant.p - home).norm(), 0, 5e-4);
}

TEST(PositionControl, ParksWhileTheClutchIsHeldAndReturnsAfterwards) {
  PositionControlConfig config = safe_config();
  const Vec3 park(0, 0.02, 0.09);
  config.park_p_MH = park;
  Plant plant(config);
  const Vec3 home = plant.p;
  for (int k = 0; k < 4000; ++k) plant.tick(Vec3::Zero(), true);
  EXPECT_NEAR((plant.p - park).norm(), 0, 5e-4);
  for (int k = 0; k < 4000; ++k) plant.tick();
  EXPECT_NEAR((plant.p - home).norm(), 0, 5e-4);
  EXPECT_LE(plant.biggest_step, 0.5 + 1e-12);
}

TEST(PositionControl, TheCueShiftsTheTargetAwayFromADangerAndBack) {
  PositionControlConfig config;
  config.danger_cue.emplace();
  config.danger_cue->script = {{milliseconds(600), milliseconds(300), Vec3(0, 0, -0.5)}};
  PositionControl control(config, 0.001);
  const Vec3 p(0, 0, 0.12);
  LimitSet set = 0;
  TimePoint now{};
  Vec3 last = Vec3(0, 0.3 * 9.81, 0);
  const auto run = [&](int ticks, const Vec3& danger) {
    for (int k = 0; k < ticks; ++k, now += milliseconds(1)) {
      const Vec3 f = control.step(now, {.p_MH = p, .danger_M = danger}, set);
      EXPECT_LE((f - last).norm(), 0.5 + 1e-12);
      last = f;
    }
    return Vec3(control.target() - p);
  };
  // The grip is held still: what the hand feels is the stretched spring, kp times the shift.
  EXPECT_NEAR((run(300, Vec3(3, 0, 0)) - Vec3(-0.02, 0, 0)).norm(), 0, 1e-15);
  EXPECT_NEAR(last.x(), -150 * 0.02, 0.1);
  EXPECT_EQ(run(300, Vec3::Zero()), Vec3::Zero());
  EXPECT_NEAR((run(200, Vec3::Zero()) - Vec3(0, 0, 0.01)).norm(), 0, 1e-15);
  EXPECT_NEAR(run(250, Vec3::Constant(NAN)).norm(), 0, 1e-15);
}

}  // namespace
}  // namespace farhand
