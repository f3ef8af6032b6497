#include "master/force_controller.hpp"

#include <gtest/gtest.h>

#include "master/compensation.hpp"

namespace farhand {
namespace {

constexpr ForceControllerConfig kConfig{
    .limits = {
        .force = 10, .torque = 1, .twist_torque = 0.15, .force_step = 0.5, .torque_step = 0.1}};

TEST(ForceController, OpenLoopReflectsTheEnvironmentWhateverTheUserDoes) {
  const Wrench F_env{Vec3(0.3, -0.1, 0.2), Vec3(0.02, 0, 0.01)},
      F_user{Vec3(9, 9, 9), Vec3(1, 1, 1)};
  ForceController with(kConfig), without(kConfig);
  LimitSet set = 0;
  const Wrench a = with.step(F_env, &F_user, set), b = without.step(F_env, nullptr, set);
  EXPECT_EQ(a.force, -F_env.force);
  EXPECT_EQ(a.torque, -F_env.torque);
  EXPECT_EQ(b.force, a.force);
  EXPECT_EQ(set, kLimitNone);
}

TEST(ForceController, StepsOfTheEnvironmentBecomeRamps) {
  ForceController controller(kConfig);
  LimitSet set = 0;
  for (int k = 1; k <= 8; ++k)
    EXPECT_NEAR(controller.step({Vec3(-4, 0, 0), Vec3::Zero()}, nullptr, set).force.x(), 0.5 * k,
                1e-12);
  EXPECT_TRUE(set & kLimitSlew);
}

TEST(Compensation, HoldsThenFadesLinearlyToNothing) {
  using std::chrono::milliseconds;
  const CompensationConfig c{.hold = milliseconds(20), .fade = milliseconds(80)};
  EXPECT_EQ(fade(c, Duration(0)), 1);
  EXPECT_EQ(fade(c, milliseconds(20)), 1);
  EXPECT_NEAR(fade(c, milliseconds(40)), 0.75, 1e-15);
  EXPECT_EQ(fade(c, milliseconds(100)), 0);
  EXPECT_EQ(fade(c, Duration::max()), 0);
}

}  // namespace
}  // namespace farhand
