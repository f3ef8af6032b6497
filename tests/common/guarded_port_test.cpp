#include "common/guarded_port.hpp"

#include <gtest/gtest.h>

namespace farhand {
namespace {

constexpr ForceGuardConfig kConfig{};
const double kSpendable = kConfig.store - kConfig.reserve;

TEST(GuardedPort, CreditsWhatThePeerPutInSinceItWasFirstHeard) {
  GuardedPort port(kConfig);
  port.hear(100);  // ours is a new session, the peer's is not
  EXPECT_NEAR(port.left(), kSpendable, 1e-12);
  port.hear(100.5);
  EXPECT_NEAR(port.left(), kSpendable + 0.5, 1e-12);
  port.hear(100.5);
  EXPECT_NEAR(port.left(), kSpendable + 0.5, 1e-12);
}

TEST(GuardedPort, APeerThatBeginsAnewLeavesNoMoreThanTheStore) {
  GuardedPort port(kConfig);
  port.hear(0);
  port.hear(5);
  port.hear(0.1);
  EXPECT_NEAR(port.left(), kSpendable, 1e-12);
  port.hear(0.3);
  EXPECT_NEAR(port.left(), kSpendable + 0.2, 1e-12);
}

TEST(GuardedPort, WhatMovedWhileLetGoIsNoWorkAndForetellsNothing) {
  GuardedPort port(kConfig);
  const Vec3 F(10, 0, 0);
  for (int k = 0; k < 5; ++k) port.step(F, Vec3(0.001 * k, 0, 0));
  const double left = port.left(), told = port.told();
  port.let_go();
  EXPECT_EQ(port.step(F, Vec3(-0.3, 0, 0)), F);  // carried off meanwhile
  EXPECT_EQ(port.step(F, Vec3(-0.3, 0, 0)), F);
  EXPECT_EQ(port.left(), left);
  EXPECT_EQ(port.told(), told);
}

// A reading that cannot be, and back: neither spent nor earned, and the force is what it was.
TEST(GuardedPort, AStepThatNoHandMakesIsNoWork) {
  GuardedPort port(kConfig);
  const Vec3 F(10, 0, 0);
  for (int k = 0; k < 5; ++k) port.step(F, Vec3(0.001 * k, 0, 0));
  const double left = port.left(), told = port.told();
  EXPECT_EQ(port.step(F, Vec3(-0.07, 0, 0)), F);
  EXPECT_EQ(port.step(F, Vec3(0.004, 0, 0)), F);
  EXPECT_EQ(port.left(), left);
  EXPECT_EQ(port.told(), told);
}

}  // namespace
}  // namespace farhand
