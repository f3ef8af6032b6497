#include "master/falcon_usb/counts.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>

#include "common/random.hpp"
#include "master/falcon.hpp"

namespace farhand::falcon_usb {
namespace {

double angle_deg(const Vec3& a, const Vec3& b) {
  return std::atan2(a.cross(b).norm(), a.dot(b)) * 180 / std::numbers::pi;
}

Vec3 unit(Random& random) {
  return Vec3(random.normal(), random.normal(), random.normal()).normalized();
}

// Within a ball about the middle of what the hardware reaches, by default all of the largest one
// (reference section 2.4).
Vec3 place(Random& random, double radius = 0.048) {
  return Vec3(0, 0, 0.1335) + radius * std::cbrt(random.uniform()) * unit(random);
}

// What the hand feels of torques once they have been counts.
Vec3 felt(const FalconJacobian& J, const Vec3& tau) {
  return force(J, torque_of_counts(motor_counts(tau, kGainCharacterised), kGainCharacterised));
}

TEST(FalconCounts, EachMotorIsWithinHalfACount) {
  Random random(1);
  for (int i = 0; i < 100000; ++i) {
    const Vec3 tau = 0.3 * unit(random);
    const AxisWords counts = motor_counts(tau, kGainCharacterised);
    for (int k = 0; k < 3; ++k)
      ASSERT_LE(std::abs(counts[k] - kGainCharacterised * tau[k]), 0.5 + 1e-12);
  }
}

TEST(FalconCounts, TooMuchIsScaledAsAWholeAndTheLargestMotorGivesAllItCan) {
  Random random(2);
  for (int i = 0; i < 100000; ++i) {
    const Vec3 direction = unit(random);
    const double size = 2 * std::exp(10 * random.uniform());  // [N m], 2 to 44 000
    const AxisWords counts = motor_counts(size * direction, kGainCharacterised);
    const Vec3 scaled = kMostCounts / direction.cwiseAbs().maxCoeff() * direction;
    for (int k = 0; k < 3; ++k) ASSERT_LE(std::abs(counts[k] + scaled[k]), 0.5 + 1e-9);
  }
}

TEST(FalconCounts, APullTowardsTheBaseIsPositiveOnEveryMotor) {
  const FalconJacobian J = jacobian(kFalconTable1, Vec3(0, 0, 0.12));
  for (const double gain : {kGainCharacterised, kGainLibnifalcon})
    for (const auto counts : motor_counts(torque(J, Vec3(0, 0, -5)), gain)) EXPECT_GT(counts, 0);
}

TEST(FalconCounts, WhatIsNotFiniteIsNothing) {
  for (const double bad :
       {std::numeric_limits<double>::quiet_NaN(), std::numeric_limits<double>::infinity(), -1e308})
    EXPECT_EQ(motor_counts(Vec3(0.1, bad, 0.1), kGainCharacterised), AxisWords{}) << bad;
}

// 5 N to far beyond what the motors can give, over the workspace of the hardware.
TEST(FalconCounts, ForcesFrom5NPointWithinATenthOfADegree) {
  Random random(3);
  double worst = 0;
  for (int i = 0; i < 100000; ++i) {
    const FalconJacobian J = jacobian(kFalconTable1, place(random));
    ASSERT_EQ(J.status, Status::ok);
    const Vec3 f_H_M = 5 * std::exp(6 * random.uniform()) * unit(random);
    worst = std::max(worst, angle_deg(f_H_M, felt(J, torque(J, f_H_M))));
  }
  EXPECT_LE(worst, 0.1);
}

// With the encoders' counts in the way, too: the torque is worked out where they say the grip is.
TEST(FalconCounts, SoDoesTheWholeChainWithin40MmOfTheMiddle) {
  Random random(5);
  double worst = 0;
  for (int i = 0; i < 100000; ++i) {
    const Vec3 p_MH = place(random, 0.040);
    const auto counts = counts_from_theta1(kFalconTable1, motor_angles(kFalconTable1, p_MH).theta1);
    const FalconForward seen = forward(kFalconTable1, theta1_from_counts(kFalconTable1, counts));
    const Vec3 f_H_M = 5 * std::exp(6 * random.uniform()) * unit(random);
    const Vec3 tau = torque(jacobian(kFalconTable1, seen), f_H_M);
    worst = std::max(worst, angle_deg(f_H_M, felt(jacobian(kFalconTable1, p_MH), tau)));
  }
  EXPECT_LE(worst, 0.1);
}

TEST(FalconCounts, TwoHundredNewtonsSaturateInTheirDirection) {
  Random random(4);
  for (int i = 0; i < 10000; ++i) {
    const FalconJacobian J = jacobian(kFalconTable1, place(random));
    const Vec3 f_H_M = 200 * unit(random), got = felt(J, torque(J, f_H_M));
    ASSERT_LE(angle_deg(f_H_M, got), 0.1);
    ASSERT_LT(got.norm(), 200);
    ASSERT_GT(got.norm(), 5);
  }
}

}  // namespace
}  // namespace farhand::falcon_usb
