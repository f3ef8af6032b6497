#include "master/hand_linkage.hpp"

#include <gtest/gtest.h>

#include "common/random.hpp"

namespace farhand::hand_linkage_test {
namespace {

constexpr std::uint64_t kSeed = 5;

Vec3 any(Random& random, double size) {
  return size * (2 * Vec3(random.uniform(), random.uniform(), random.uniform()) - Vec3::Ones());
}

// A state near the middle with speeds, and where it is dt later.
HandState any_state(Random& random, const Vec3& middle) {
  HandState s;
  s.p_MH = middle + any(random, 0.02);
  s.v_MH = any(random, 0.1);
  s.axis_M = (Vec3::UnitZ() + any(random, 0.4)).normalized();
  s.omega_M = s.axis_M.cross(any(random, 1));
  s.twist = 2 * random.uniform() - 1;
  s.twist_rate = 2 * random.uniform() - 1;
  return s;
}

HandState later(const HandState& s, double dt) {
  HandState out = s;
  out.p_MH += dt * s.v_MH;
  out.axis_M = (s.axis_M + dt * s.omega_M.cross(s.axis_M)).normalized();
  out.twist += dt * s.twist_rate;
  return out;
}

template <typename Geometry>
class HandLinkageTest : public testing::Test {};
using Geometries = testing::Types<FalconGeometry, TwinDeltaGeometry>;
TYPED_TEST_SUITE(HandLinkageTest, Geometries);

TYPED_TEST(HandLinkageTest, MotorsDoTheWorkTheHandleReceives) {
  Random random(kSeed);
  for (int i = 0; i < 100; ++i) {
    HandLinkage<TypeParam> at(TypeParam{}), before(TypeParam{}), after(TypeParam{});
    const HandState s = any_state(random, at.middle());
    const double dt = 1e-6;
    ASSERT_TRUE(at.solve(s) && before.solve(later(s, -dt)) && after.solve(later(s, dt)));
    Vec6 tau = Vec6::Zero();
    for (int k = 0; k < at.kMotors; ++k) tau[k] = 2 * random.uniform() - 1;
    const HandLoad load = at.motors(tau);
    const double received =
        load.force.dot(s.v_MH) + load.moment.dot(s.omega_M) + load.twist * s.twist_rate;
    const double done = tau.dot(after.theta() - before.theta()) / (2 * dt);
    EXPECT_NEAR(received, done, 1e-7) << "case " << i << " seed " << kSeed;
    EXPECT_NEAR(load.moment.dot(s.axis_M), 0, 1e-12);
  }
}

TYPED_TEST(HandLinkageTest, OutsideNothingChanges) {
  HandLinkage<TypeParam> linkage{TypeParam{}};
  HandState s;
  s.p_MH = linkage.middle();
  ASSERT_TRUE(linkage.solve(s));
  const Vec6 theta = linkage.theta(), tau = Vec6::Constant(0.1);
  const Vec3 force = linkage.motors(tau).force;
  for (const Vec3& far : {Vec3(1, 0, 0), Vec3(0, 0, 0.7), Vec3(NAN, 0, 0)}) {
    s.p_MH = linkage.middle() + far;
    EXPECT_FALSE(linkage.solve(s));
    EXPECT_EQ(linkage.theta(), theta);
    EXPECT_EQ(linkage.motors(tau).force, force);
  }
}

TYPED_TEST(HandLinkageTest, TheAcceptedBallIsInside) {
  Random random(kSeed);
  HandLinkage<TypeParam> linkage{TypeParam{}};
  HandState s;
  for (int i = 0; i < 1000; ++i) {
    s.p_MH = linkage.middle() + 0.055 * any(random, 1).normalized();
    EXPECT_TRUE(linkage.solve(s)) << s.p_MH.transpose() << " seed " << kSeed;
  }
}

}  // namespace
}  // namespace farhand::hand_linkage_test
