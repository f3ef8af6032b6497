#include "master/closure.hpp"

#include <gtest/gtest.h>

#include <numbers>

#include "tests/support/differences.hpp"

namespace farhand {
namespace {

using support::in_cube, support::uniform;

TEST(Closure, TwoBarsMeetTheLegEndOnTheAskedSide) {
  constexpr std::uint64_t kSeed = 31;
  std::mt19937_64 random(kSeed);
  int solved = 0;
  for (int k = 0; k < 10'000; ++k) {
    const double arm = uniform(random, 0.05, 0.2), bar = uniform(random, 0.05, 0.2);
    const double x = uniform(random, -0.3, 0.3), y = uniform(random, -0.3, 0.3);
    const double reach = std::hypot(x, y);
    const TwoBar t = two_bar(arm, bar, reach);
    ASSERT_EQ(t.status == Status::ok, reach <= arm + bar && reach >= std::abs(arm - bar));
    if (t.status != Status::ok) continue;
    ++solved;
    for (const double bend : {1.0, -1.0}) {
      const double theta = arm_direction(t, x, y, bend).angle();
      const double ex = x - arm * std::cos(theta), ey = y - arm * std::sin(theta);
      EXPECT_NEAR(std::hypot(ex, ey), bar, 1e-14) << "seed " << kSeed;
      EXPECT_GE(bend * (std::cos(theta) * ey - std::sin(theta) * ex), -1e-12) << "seed " << kSeed;
      const double knee = std::atan2(t.sine, t.knee_cos);
      const double bent = theta + bend * knee;
      EXPECT_NEAR(arm * std::cos(theta) + bar * std::cos(bent), x, 1e-14) << "seed " << kSeed;
      EXPECT_NEAR(arm * std::sin(theta) + bar * std::sin(bent), y, 1e-14) << "seed " << kSeed;
    }
  }
  EXPECT_GT(solved, 3000);
}

TEST(Closure, TwoBarsAtTheEdgesAreStraightOrFoldedNotNaN) {
  const TwoBar straight = two_bar(0.25, 0.5, 0.75), folded = two_bar(0.25, 0.5, 0.25);
  EXPECT_EQ(straight.status, Status::ok);
  EXPECT_EQ(straight.sine, 0);
  EXPECT_GT(straight.knee_cos, 0);
  EXPECT_EQ(folded.status, Status::ok);
  EXPECT_LT(folded.knee_cos, 0);
  EXPECT_EQ(two_bar(0.25, 0.5, 0.7500001).status, Status::too_far);
  EXPECT_EQ(two_bar(0.25, 0.5, 0.2499999).status, Status::too_close);
  EXPECT_EQ(two_bar(0.5, 0.25, 0.2499999).status, Status::too_close);
  EXPECT_EQ(two_bar(0.5, 0.5, 0).status, Status::too_close);
  EXPECT_EQ(two_bar(0.5, 0.5, INFINITY).status, Status::too_far);
  EXPECT_EQ(two_bar(0.5, 0.5, NAN).status, Status::too_far);
}

TEST(Closure, BothMeetingPointsLieOnAllThreeSpheres) {
  constexpr std::uint64_t kSeed = 32;
  std::mt19937_64 random(kSeed);
  for (int k = 0; k < 10'000; ++k) {
    const Vec3 meeting = in_cube(random);
    Mat3 S;
    Vec3 radii;
    for (int i = 0; i < 3; ++i) {
      S.col(i) = in_cube(random);
      radii[i] = (S.col(i) - meeting).norm();
    }
    const SphereMeeting m = meet(S, radii);
    const double thin = (S.col(1) - S.col(0)).cross(S.col(2) - S.col(0)).norm();
    if (thin < 0.1 || m.lift.norm() < 0.01) continue;
    ASSERT_EQ(m.status, Status::ok) << "seed " << kSeed;
    for (const double side : {1.0, -1.0})
      for (int i = 0; i < 3; ++i)
        EXPECT_NEAR((m.foot + side * m.lift - S.col(i)).norm(), radii[i], 1e-11);
    const double nearest =
        std::min((m.foot + m.lift - meeting).norm(), (m.foot - m.lift - meeting).norm());
    EXPECT_LE(nearest, 1e-11) << "seed " << kSeed;
  }
}

TEST(Closure, SpheresThatDoNotMeetOrLineUpSaySo) {
  Mat3 S = Mat3::Identity();
  EXPECT_EQ(meet(S, Vec3::Constant(0.1)).status, Status::no_solution);
  EXPECT_EQ(meet(S, Vec3::Constant(0.1)).lift, Vec3::Zero());
  S << 0, 1, 2, 0, 0, 0, 0, 0, 0;
  EXPECT_EQ(meet(S, Vec3::Constant(3)).status, Status::singular);
}

TEST(Closure, SolvingWithThreeRowsIgnoresTheirScale) {
  constexpr std::uint64_t kSeed = 33;
  std::mt19937_64 random(kSeed);
  for (int k = 0; k < 10'000; ++k) {
    Mat3 A;
    for (int i = 0; i < 3; ++i) A.row(i) = support::on_sphere(random);
    if (std::abs(A.determinant()) < 0.05) continue;
    const Vec3 x = in_cube(random);
    A.row(1) *= 1e9;
    EXPECT_LE((solve(three_rows(A), A * x) - x).norm(), 1e-13) << "seed " << kSeed;
    const Vec3 y = solve_transposed(three_rows(A), x);
    EXPECT_LE((A.transpose() * y - x).norm(), 1e-13) << "seed " << kSeed;
  }
}

TEST(Closure, ABarMapWithoutABarOrALeverAnswersZero) {
  Mat3 flat = Mat3::Identity();
  flat.row(2) = flat.row(1);
  for (const BarMap& m : {make_bar_map(flat, Vec3::Ones()),
                          make_bar_map(Mat3::Identity(), Vec3(1, 0, 1)), BarMap{}}) {
    EXPECT_EQ(m.status, Status::singular);
    EXPECT_EQ(torque(m, Vec3::Ones()), Vec3::Zero());
    EXPECT_EQ(force(m, Vec3::Ones()), Vec3::Zero());
    EXPECT_EQ(theta_rates(m, Vec3::Ones()), Vec3::Zero());
    EXPECT_EQ(velocity(m, Vec3::Ones()), Vec3::Zero());
  }
}

}  // namespace
}  // namespace farhand
