#include "common/method_choice.hpp"

#include <gtest/gtest.h>

#include <cstring>

namespace farhand {
namespace {

const MethodChoice& after(MethodChooser& c, double seconds, double rtt, bool sure, double felt) {
  const MethodEvidence e{.rtt = rtt, .sure = sure, .felt = felt};
  for (double t = 0; t < seconds; t += 0.001) c.step(e, 0.001);
  return c.step(e, 0.001);
}

TEST(MethodChooser, GoesByDelayAndByWhatIsKnown) {
  MethodChooser c({.device_damping = 10, .stiffest = 1000});
  EXPECT_NEAR(c.direct_limit(), 0.005, 1e-15);
  EXPECT_EQ(after(c, 0, 0, false, 0).method, Method::damped);  // nothing known yet
  EXPECT_EQ(after(c, 0, 0.002, false, 0).method, Method::direct);
  EXPECT_EQ(after(c, 0, 0.050, false, 0).method, Method::damped);
  EXPECT_EQ(after(c, 0.9, 0.050, true, 0).method, Method::damped);
  EXPECT_EQ(after(c, 0.2, 0.050, true, 0).method, Method::mmt);
  EXPECT_EQ(after(c, 0, 0.050, false, 0).method, Method::damped);
  EXPECT_GT(std::strlen(after(c, 0, 0.050, false, 0).reason), 10u);
}

TEST(MethodChooser, DoesNotGoBackAndForthAtTheLimit) {
  MethodChooser c({});
  EXPECT_EQ(after(c, 0, 0.0045, false, 0).method, Method::damped);
  EXPECT_EQ(after(c, 0, 0.0039, false, 0).method, Method::direct);
  EXPECT_EQ(after(c, 0, 0.0045, false, 0).method, Method::direct);
  EXPECT_EQ(after(c, 0, 0.0055, false, 0).method, Method::damped);
}

TEST(MethodChooser, WaitsUntilLittleIsFelt) {
  MethodChooser c({});
  after(c, 0, 0.002, false, 0);
  EXPECT_EQ(after(c, 1, 0.008, false, 3).method, Method::direct);
  EXPECT_EQ(after(c, 0, 0.008, false, 0.4).method, Method::damped);
}

TEST(MethodChooser, LeavesDirectFeedbackAtOnceWhereItWouldRing) {
  MethodChooser c({});
  after(c, 0, 0.002, false, 0);
  EXPECT_EQ(after(c, 0, 0.0101, false, 3).method, Method::damped);
}

TEST(MethodChooser, LeavesDirectFeedbackThatRingsUntilUncoupled) {
  MethodChooser c({});
  after(c, 0, 0.002, false, 0);
  EXPECT_EQ(c.step({.rtt = 0.002, .felt = 3, .ringing = true}, 0.001).method, Method::damped);
  EXPECT_EQ(after(c, 1, 0.002, false, 0).method, Method::damped);
  c.forget();
  EXPECT_EQ(after(c, 0, 0.002, false, 0).method, Method::direct);
}

TEST(MethodChooser, KnowsThatAStifferWallBearsLessDelay) {
  MethodChooser c({.device_damping = 10, .stiffest = 1000});
  EXPECT_EQ(c.step({.rtt = 0.002, .stiffness = 3000}, 0.001).method, Method::damped);
  EXPECT_EQ(c.step({.rtt = 0.002, .stiffness = 300}, 0.001).method, Method::direct);
}

TEST(MethodBlend, ChangesAForceWithoutAJump) {
  MethodBlend b;
  const Vec3 still = Vec3::Zero(), F_new(1, 0, 0);
  EXPECT_EQ(b.step(0.001), 1);
  b.start(Vec3(5, 0, 0));
  double last = 5;
  for (int i = 0; i < 310; ++i) {
    const double share = b.step(0.001);
    const double F = (share * F_new + b.rest(still)).x();
    EXPECT_LE(std::abs(F - last), 5 * 0.001 / MethodBlend::kTime + 1e-12);
    last = F;
  }
  EXPECT_EQ(last, 1);
}

TEST(MethodBlend, WhatIsLeftOfTheOldForceDrivesNobody) {
  MethodBlend b;
  b.start(Vec3(5, 0, 0));
  b.step(0.001);
  EXPECT_GT(b.rest(Vec3(0.1, 0, 0)).x(), 4.9);
  EXPECT_EQ(b.rest(Vec3(-0.1, 0, 0)), Vec3::Zero());
}

}  // namespace
}  // namespace farhand
