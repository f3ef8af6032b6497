#include "master/position_control.hpp"

#include <gtest/gtest.h>

namespace farhand {
namespace {

using std::chrono::milliseconds;

TEST(PositionControl, HoldsTheGripWhereItWasSwitchedOnAndCarriesItsWeight) {
  PositionControl control({}, 0.01);
  LimitSet set = 0;
  const Vec3 p(0.01, 0.02, 0.12);
  EXPECT_NEAR((control.step(TimePoint{}, p, set) - Vec3(0, 0.3 * 9.81, 0)).norm(), 0, 1e-15);
  EXPECT_EQ(control.target(), p);
  EXPECT_EQ(set, kLimitNone);
}

TEST(PositionControl, TakesItsSetPointsInTimeCountedFromTheFirstSample) {
  const Vec3 a(0.01, 0, 0.12), b(0, 0.01, 0.12);
  PositionControl control({.set_points = {{milliseconds(100), a}, {milliseconds(200), b}}}, 0.01);
  const TimePoint start{std::chrono::hours(5)};
  LimitSet set = 0;
  control.step(start, Vec3(0, 0, 0.12), set);
  EXPECT_EQ(control.target(), Vec3(0, 0, 0.12));
  control.step(start + milliseconds(100), Vec3(0, 0, 0.12), set);
  EXPECT_EQ(control.target(), a);
  control.step(start + milliseconds(500), Vec3(0, 0, 0.12), set);
  EXPECT_EQ(control.target(), b);
}

TEST(PositionControl, ForceIsCappedInItsDirection) {
  PositionControl control({.pid = {.kp = 1000}, .max_force = 5, .gravity_mass = 0}, 0.01);
  LimitSet set = 0;
  control.step(TimePoint{}, Vec3::Zero(), set);
  const Vec3 f = control.step(TimePoint{}, Vec3(-0.03, 0.04, 0), set);
  EXPECT_NEAR((f - Vec3(3, -4, 0)).norm(), 0, 1e-14);
  EXPECT_TRUE(set & kLimitForce);
}

}  // namespace
}  // namespace farhand
