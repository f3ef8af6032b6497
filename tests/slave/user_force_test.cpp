#include "slave/user_force.hpp"

#include <gtest/gtest.h>

#include <cmath>

namespace farhand {
namespace {

TEST(UserForce, PushesWithItsShareUpToTheLimits) {
  const UserForceConfig c{.share = 0.5, .max_force = 3, .max_torque = 0.2};
  const Wrench F = pushed(c, {.force = {4, 0, 0}, .torque = {0, 0.1, 0}});
  EXPECT_EQ(F.force, Vec3(2, 0, 0));
  EXPECT_EQ(F.torque, Vec3(0, 0.05, 0));
  const Wrench most = pushed(c, {.force = {30, 40, 0}, .torque = {0, 0, -9}});
  EXPECT_NEAR((most.force - Vec3(1.8, 2.4, 0)).norm(), 0, 1e-15);  // its direction stays
  EXPECT_NEAR(most.torque.z(), -0.2, 1e-15);
}

TEST(UserForce, WhatIsNotFinitePushesNothing) {
  EXPECT_EQ(pushed({}, {.force = {NAN, 0, 0}}).force, Vec3::Zero());
  Admittance a({});
  const Pose X = a.step({}, {.force = {0, INFINITY, 0}}, {}, false);
  EXPECT_EQ(X.p, Vec3::Zero());
}

TEST(Admittance, MovesAsMassAndDamper) {
  const AdmittanceConfig c{.Ts = 0.001, .mass = 2, .damping = 10};
  Admittance a(c);
  Pose X;
  for (int k = 0; k < 3000; ++k) X = a.step(X, {.force = {5, 0, 0}}, {}, false);
  const double tau = c.mass / c.damping, v = 5 / c.damping, t = 3;
  EXPECT_NEAR(X.p.x(), v * (t - tau * (1 - std::exp(-t / tau))), v * c.Ts);
}

TEST(Admittance, RestsWhereTheEnvironmentHoldsTheUserBack) {
  Admittance a({.mass = 1, .damping = 20});
  Pose X;
  for (int k = 0; k < 20000; ++k) X = a.step(X, {.force = {0, 4, 0}}, {.force = 400 * X.p}, false);
  EXPECT_NEAR(X.p.y(), 0.01, 1e-9);
}

TEST(Admittance, StaysARotationAndKeepsALockedOne) {
  Admittance a({.max_turn_rate = 6});
  Pose X;
  for (int k = 0; k < 200000; ++k) X = a.step(X, {.torque = {0.3, 0.2, -0.1}}, {}, false);
  EXPECT_NEAR((X.R.transpose() * X.R - Mat3::Identity()).cwiseAbs().maxCoeff(), 0, 1e-15);
  const Mat3 R = X.R;
  EXPECT_EQ(a.step(X, {.torque = {1, 1, 1}}, {}, true).R, R);
}

TEST(Admittance, IsNeverFasterThanItsLimit) {
  Admittance a({.damping = 0, .max_speed = 0.5});
  Pose X;
  for (int k = 0; k < 1000; ++k) {
    const Pose next = a.step(X, {.force = {1e9, 0, 0}}, {}, false);
    ASSERT_LE((next.p - X.p).norm(), 0.5e-3 * (1 + 1e-12));
    X = next;
  }
}

}  // namespace
}  // namespace farhand
