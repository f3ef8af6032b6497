// The inverse as the tick uses it: sample after sample, from the previous one.
#include <gtest/gtest.h>

#include <numbers>

#include "slave/arm.hpp"
#include "tests/support/arm_reference.hpp"

namespace farhand::arm_motion_test {
namespace {

constexpr unsigned kSeed = 7104;
constexpr double kPi = std::numbers::pi;
const ArmGeometry kArm;
const JointLimits kLimits;

// A straight line of the tool axis past the forearm's, seen along the forearm: t ahead [rad],
// `distance` aside, from the direction `azimuth`; the rest of the arm moves on slowly.
std::array<long double, 6> passing(long double t, long double azimuth, long double distance) {
  const long double sign = t < 0 ? -1 : 1;
  const long double aside =
      t == 0 ? std::numbers::pi_v<long double> / 2 * (distance > 0) : std::atan(distance / t);
  return {1.2L + 0.3L * t,
          1.7L - 0.2L * t,
          -0.6L + 0.1L * t,
          azimuth + aside,
          sign * std::hypot(t, distance),
          0.4L - 0.5L * t - aside};
}

struct Passage {
  double excess = 0;     // of the largest joint step over that of the path [rad]
  double deviation = 0;  // from the path at its end
};
Passage follow(long double azimuth, long double distance, long double offset) {
  const auto at = [&](int k) { return passing((k + offset) * 1e-3L, azimuth, distance); };
  const auto as_vec = [](const auto& q) {
    Vec6 out;
    for (std::size_t i = 0; i < 6; ++i) out[static_cast<Eigen::Index>(i)] = double(q[i]);
    return out;
  };
  Passage out;
  Vec6 q = as_vec(at(-200));
  for (int k = -199; k <= 200; ++k) {
    const ArmNearest n =
        inverse(kArm, kLimits, reference::rounded(reference::forward(kArm, at(k))), q);
    EXPECT_EQ(n.status, Status::ok);
    const Vec6 step = as_vec(at(k)) - as_vec(at(k - 1));
    out.excess = std::max(out.excess, ((n.q - q).cwiseAbs() - step.cwiseAbs()).maxCoeff());
    q = n.q;
  }
  out.deviation = (q - as_vec(at(200))).cwiseAbs().maxCoeff();
  return out;
}

// `nearest` [rad] is the smallest |q5| of a sample: the pose's rounding alone, some 2e-16, turns q4
// by 2e-16 / nearest, in exact arithmetic too.
Passage worst_passage(long double distance, long double offset, double nearest) {
  Passage worst;
  for (int k = 0; k < 64; ++k) {
    const Passage p = follow(-1.5L + 0.047L * k, distance, offset);
    worst.excess = std::max(worst.excess, p.excess);
    worst.deviation = std::max(worst.deviation, p.deviation);
  }
  std::printf(
      "axes 4 and 6 pass %.0e rad apart, sample nearest %.0e: step excess %.1e, after %.1e\n",
      static_cast<double>(distance), nearest, worst.excess, worst.deviation);
  return worst;
}

TEST(ArmMotion, PassesThroughTheWristSingularityWithoutATurn) {
  for (const double nearest : {0.0, 1e-8, 1e-6, 3e-4}) {
    const Passage p = worst_passage(0, nearest * 1e3L, nearest);
    EXPECT_LT(p.excess, 1e-7) << nearest;
    EXPECT_LT(p.deviation, 1e-13) << nearest;
  }
  EXPECT_LT(worst_passage(0, 1e-6L, 1e-9).excess, 1e-15 / 1e-9);
}

TEST(ArmMotion, PassesBesideTheWristSingularityWithoutATurn) {
  for (const double nearest : {1e-6, 1e-4, 3e-4}) {
    const Passage p = worst_passage(1e-9L, nearest * 1e3L, nearest);
    EXPECT_LT(p.excess, 1e-7) << nearest;
    EXPECT_LT(p.deviation, 1e-11) << nearest;
  }
}

// Then the path itself takes two quarter turns of q4 and q6, and the second may as well go the
// other way round: equal but for what else q4 and q6 do in that sample (1e-3).
TEST(ArmMotion, ASampleAtTheClosestPointTurnsNoMoreThanThePath) {
  const Passage p = worst_passage(1e-9L, 0, 1e-9);
  EXPECT_LT(p.excess, 1.01e-3);
  EXPECT_LT(std::min(p.deviation, std::abs(p.deviation - kPi)), 1e-11);
}

Vec6 degrees(double a, double b, double c, double d, double e, double f) {
  return joints_from_degrees({a, b, c, d, e, f});
}

TEST(ArmMotion, KeepsShoulderElbowAndWristInMotion) {
  std::mt19937_64 rng(kSeed);
  const double deg = kPi / 180;
  for (int n = 0; n < 100000; ++n) {
    const Vec6 before = reference::random_joints(rng);
    Vec6 q = before;
    for (int i = 0; i < 6; ++i) q[i] += reference::uniform(rng, -deg, deg);
    q = q.cwiseMax(kLimits.lower).cwiseMin(kLimits.upper);
    const ArmKinematics was = kinematics(kArm, before), is = kinematics(kArm, q);
    if (was.r * is.r <= 0 || was.cos_q3 * is.cos_q3 <= 0) continue;
    const ArmNearest found = inverse(kArm, kLimits, is.X_SE, before);
    ASSERT_EQ(found.status, Status::ok) << "seed " << kSeed << " n " << n;
    const ArmSingularity& m = is.singularity;
    ASSERT_LT((found.q - q).cwiseAbs().maxCoeff(), 1e-14 / (m.wrist * m.elbow * m.shoulder))
        << "seed " << kSeed << " n " << n;
    EXPECT_EQ(found.branch.shoulder, is.r > 0 ? 1 : -1);
    EXPECT_EQ(found.branch.elbow, is.cos_q3 > 0 ? 1 : -1);
    EXPECT_EQ(found.branch.wrist, is.sin_q5 > 0 ? 1 : -1);
  }
}

// The wrist centre passes over axis 1, or a little beside the middle of a sample, 0.8 mm at a time,
// while joint 1 turns on slowly. On the axis itself joint 1 waits for a sample.
TEST(ArmMotion, PassesOverTheShoulderWithoutAHalfTurn) {
  constexpr double kTurn = 1e-4;
  Vec6 over;
  over << 1.2, 0, 0.6, 0.3, 0.7, -0.2;
  over[1] =
      std::atan2(kArm.d4 * std::cos(over[2]), kArm.a2 + kArm.d4 * std::sin(over[2])) + kPi / 2;
  for (const double beside : {0.0, 1e-9, 1e-6, 1e-4}) {
    const auto at = [&](int k) -> Vec6 {
      return over + (Vec6() << kTurn * k, -2e-3 * k + beside, 0, 0, 0, 0).finished();
    };
    Vec6 q = at(-100);
    for (int k = -99; k <= 100; ++k) {
      const ArmNearest n = inverse(kArm, kLimits, forward(kArm, at(k)), q);
      ASSERT_EQ(n.status, Status::ok) << beside << " rad beside, sample " << k;
      ASSERT_LT((n.q - at(k)).cwiseAbs().maxCoeff(), beside + k == 0 ? 1.5 * kTurn : 1e-6)
          << beside << " rad beside, sample " << k;
      q = n.q;
    }
  }
}

TEST(ArmMotion, UnwrapsTheLastJointUpToItsLimitAndThenHolds) {
  Vec6 q = kTeleopHome, target = q;
  for (int k = 0; k <= 500; ++k) {
    target[5] = 0.0144 * k;  // past 360 deg at k = 437
    const ArmNearest found = inverse(kArm, kLimits, forward(kArm, target), q);
    if (target[5] <= kLimits.upper[5]) {
      ASSERT_EQ(found.status, Status::ok) << k;
      ASSERT_LT((found.q - target).norm(), 1e-14) << k;
    } else {
      ASSERT_EQ(found.status, Status::out_of_limits) << k;
      ASSERT_EQ(found.q, q) << k;
      if (target[5] > kLimits.upper[5] + 2) break;  // from there on another turn is nearer
    }
    q = found.q;
  }
}

TEST(ArmMotion, AJointOnItsLimitIsWithinIt) {
  for (const Vec6& q : {kLimits.lower, kLimits.upper}) {
    const ArmNearest found = inverse(kArm, kLimits, forward(kArm, q), q);
    ASSERT_EQ(found.status, Status::ok);
    EXPECT_LT((found.q - q).norm(), 2e-14);
    EXPECT_TRUE((found.q.array() >= kLimits.lower.array()).all());
    EXPECT_TRUE((found.q.array() <= kLimits.upper.array()).all());
  }
}

TEST(ArmMotion, AxesInLineKeepTheFourthJoint) {
  for (const double q4 : {-2.0, 0.3, 3.0}) {
    Vec6 q = degrees(90, 90, 0, 0, 0, 40);  // table II, tool turned
    const Pose X = forward(kArm, q);
    q[3] = q4, q[5] -= q4;
    const ArmNearest found = inverse(kArm, kLimits, X, q);
    ASSERT_EQ(found.status, Status::ok);
    EXPECT_EQ(found.q[3], q4);
    EXPECT_LT((found.q - q).norm(), 1e-15);
    EXPECT_LT(found.singularity.wrist, 1e-15);
    const ArmInverse all = inverse_all(kArm, X, q);
    for (const Vec6& r : all.rows)
      EXPECT_LT((forward(kArm, r).R - X.R).cwiseAbs().maxCoeff(), 1e-14) << r.transpose();
    EXPECT_EQ(all.rows[0][3], q4);
    EXPECT_EQ(all.rows[1], all.rows[0]);
  }
}

TEST(ArmMotion, AWristCentreOnAxisOneKeepsTheFirstJoint) {
  const Mat3 R(Eigen::AngleAxisd(0.7, Vec3::UnitX()));
  const Pose on_axis{R, Vec3(0, 0, kArm.d1 + 0.2) + kArm.d6 * R.col(2)};
  for (const double q1 : {-1.0, 0.5, 4.0}) {
    const ArmInverse all = inverse_all(kArm, on_axis, Vec6::Constant(q1));
    ASSERT_EQ(all.status, Status::ok);
    for (const Vec6& r : all.rows) {
      EXPECT_LT(std::abs(std::remainder(r[0] - q1, 2 * kPi)), 1e-15);
      EXPECT_LT((forward(kArm, r).p - on_axis.p).norm(), 1e-15) << r.transpose();
      EXPECT_LT((forward(kArm, r).R - R).cwiseAbs().maxCoeff(), 2e-15) << r.transpose();
    }
    Vec6 q = all.rows[0];
    q[0] = q1;
    const ArmNearest found = inverse(kArm, kLimits, on_axis, q);
    ASSERT_EQ(found.status, Status::ok);
    EXPECT_EQ(found.singularity.shoulder, 0);
    EXPECT_EQ(found.q[0], q1);
    EXPECT_LT((found.q - q).norm(), 2e-15);
  }
}

// Out to full stretch and back, with the elbow on either side of straight.
TEST(ArmMotion, AStretchedElbowComesBackOnItsOwnSide) {
  for (const double side : {1.0, -1.0}) {
    Vec6 q = degrees(90, 60, 90 - side * 5, 10, 40, 20);
    const Mat3 R = forward(kArm, q).R;
    for (const double rho : {0.4895, 0.49, 0.49, 0.4895}) {
      const Pose X{R, Vec3(0, rho * 0.8, kArm.d1 + rho * 0.6) + kArm.d6 * R.col(2)};
      const ArmNearest found = inverse(kArm, kLimits, X, q);
      ASSERT_EQ(found.status, Status::ok) << side << " " << rho;
      EXPECT_EQ(found.branch.elbow, side);
      q = found.q;
    }
    EXPECT_GT(side * (kPi / 2 - q[2]), 0.01);
  }
}

}  // namespace
}  // namespace farhand::arm_motion_test
