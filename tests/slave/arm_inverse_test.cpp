#include <gtest/gtest.h>

#include <numbers>

#include "slave/arm.hpp"
#include "tests/support/arm_reference.hpp"
#include "tests/support/golden.hpp"

namespace farhand::arm_inverse_test {
namespace {

constexpr unsigned kSeed = 7103;
constexpr double kPi = std::numbers::pi;
const ArmGeometry kArm;
const JointLimits kLimits;

Pose target(const golden::Json& in) {
  const Eigen::VectorXd q = golden::column(in.at("quat_wxyz"));
  return {Quat(q[0], q[1], q[2], q[3]).normalized().toRotationMatrix(), golden::column(in.at("p"))};
}
ArmBranch branch(const golden::Json& j, int wrist) {
  return {j.at("shoulder").get<int>(), j.at("elbow").get<int>(), wrist};
}
const Vec6& row(const ArmInverse& all, const ArmBranch& b) {
  return all.rows[static_cast<std::size_t>(row_of(b))];
}

void eight_rows(const golden::Json& v, golden::Checker& check) {
  const ArmInverse all = inverse_all(kArm, target(v["in"]), kTeleopHome);
  ASSERT_EQ(all.status, Status::ok) << check.where();
  for (const auto& s : v["out"]["solutions"])
    check.angles("q", row(all, branch(s, s["wrist"].get<int>())), s["q"], v["tol"]);
}

void wrist_in_line(const golden::Json& v, golden::Checker& check) {
  const ArmInverse all = inverse_all(kArm, target(v["in"]), kTeleopHome);
  ASSERT_EQ(all.status, Status::ok) << check.where();
  for (const auto& f : v["out"]["families"]) {
    for (const int k : {1, -1}) {
      const Vec6& q = row(all, branch(f, k));
      check.angle("q1", q[0], f["q1"], v["tol"]);
      check.angle("q2", q[1], f["q2"], v["tol"]);
      check.angle("q3", q[2], f["q3"], v["tol"]);
      if (!f["wrist_singular"].get<bool>()) continue;
      check.angle("q5", q[4], f["q5"], v["tol"]);
      const bool folded = f["q4_plus_q6"].is_null();
      check.angle("q4 and q6", folded ? q[5] - q[3] : q[3] + q[5],
                  f[folded ? "q6_minus_q4" : "q4_plus_q6"], v["tol"]);
    }
    if (!f["wrist_singular"].get<bool>())
      check.angles("q", row(all, branch(f, 1)), f["q"], v["tol"]);
  }
}

void unreachable(const golden::Json& v, golden::Checker& check) {
  const ArmInverse all = inverse_all(kArm, target(v["in"]), kTeleopHome);
  const bool far = v["out"]["reason"].get<std::string>() == "too_far";
  EXPECT_EQ(all.status, far ? Status::too_far : Status::too_close) << check.where();
  EXPECT_GT(all.miss, 0) << check.where();
  const ArmNearest nearest = inverse(kArm, kLimits, target(v["in"]), kTeleopHome);
  EXPECT_EQ(nearest.status, all.status) << check.where();
  EXPECT_EQ(nearest.q, kTeleopHome) << check.where();
}

TEST(ArmInverse, golden) {
  golden::run(
      "serial",
      {{"ik", eight_rows}, {"ik_wrist_singular", wrist_in_line}, {"ik_unreachable", unreachable}},
      {"fk", "jacobian", "static",  // arm_test
       "mapping"});                 // workspace_test
}

// delta [rad] from where one factor of det J vanishes; 0 leaves the configuration as it is.
enum class Near { nothing, wrist, elbow, shoulder };
Vec6 configuration(std::mt19937_64& rng, Near near, double delta) {
  for (;;) {
    Vec6 q = reference::random_joints(rng, kLimits);
    const double side = reference::uniform(rng, -1, 1) < 0 ? -1 : 1;
    const double A = kArm.a2 + kArm.d4 * std::sin(q[2]), B = kArm.d4 * std::cos(q[2]);
    if (near == Near::wrist) q[4] = side * delta;
    if (near == Near::elbow) q[2] = std::copysign(kPi / 2, q[2]) + side * delta;
    if (near == Near::shoulder) q[1] = std::atan2(B, A) + kPi / 2 + side * delta;
    if (((q - kLimits.lower).array() >= 0).all() && ((kLimits.upper - q).array() >= 0).all())
      return q;
  }
}

struct Sweep {
  reference::PoseError rows, nearest;
  double returned = 0;  // worst |q - q_original| times the measures
  int solved = 0, total = 0;
};

void solve_one(const Vec6& q, Sweep& s) {
  const Pose X_SE = reference::rounded(reference::forward(kArm, q));
  const ArmInverse all = inverse_all(kArm, X_SE, q);
  const ArmNearest nearest = inverse(kArm, kLimits, X_SE, q);
  ++s.total;
  s.solved += all.status == Status::ok && nearest.status == Status::ok;
  for (const Vec6& r : all.rows) {
    s.rows.raise(reference::pose_error(reference::forward(kArm, r), X_SE));
    EXPECT_TRUE((r.array() > -kPi).all() && (r.array() <= kPi).all()) << r.transpose();
  }
  s.nearest.raise(reference::pose_error(reference::forward(kArm, nearest.q), X_SE));
  const ArmSingularity& m = nearest.singularity;
  s.returned = std::max(s.returned, (nearest.q - q).cwiseAbs().maxCoeff() * m.wrist * m.elbow *
                                        std::min(1.0, m.shoulder / 0.49));
}

Sweep sweep(Near near, double delta, int count) {
  std::mt19937_64 rng(kSeed);
  Sweep s;
  for (int n = 0; n < count; ++n) solve_one(configuration(rng, near, delta), s);
  return s;
}

void expect_exact(const char* where, double delta, const Sweep& s) {
  std::printf(
      "%-9s %.0e: %d of %d solved; eight rows %.2e m %.2e; nearest %.2e m %.2e, "
      "back to q within %.1e / measures\n",
      where, delta, s.solved, s.total, s.rows.position, s.rows.rotation, s.nearest.position,
      s.nearest.rotation, s.returned);
  EXPECT_EQ(s.solved, s.total) << where << delta << " seed " << kSeed;
  EXPECT_LT(std::max(s.rows.position, s.nearest.position), 2e-15) << where << delta;
  EXPECT_LT(std::max(s.rows.rotation, s.nearest.rotation), 1e-14) << where << delta;
  EXPECT_LT(s.returned, 2e-14) << where << delta << " seed " << kSeed;
}

TEST(ArmInverse, EveryRowReachesThePoseAnywhereInTheLimits) {
  expect_exact("anywhere", 0, sweep(Near::nothing, 0, 100000));
}

TEST(ArmInverse, EveryRowReachesThePoseNextToTheSingularities) {
  for (const double delta : {1e-3, 1e-6, 1e-9}) {
    expect_exact("wrist", delta, sweep(Near::wrist, delta, 10000));
    expect_exact("elbow", delta, sweep(Near::elbow, delta, 10000));
    expect_exact("shoulder", delta, sweep(Near::shoulder, delta, 10000));
  }
}

Mat3 random_rotation(std::mt19937_64& rng) {
  std::normal_distribution<double> normal;
  return Quat(normal(rng), normal(rng), normal(rng), normal(rng)).normalized().toRotationMatrix();
}
// The wrist centre `rho` from the shoulder, direction and tool orientation at random.
Pose random_pose(std::mt19937_64& rng, double rho) {
  const Mat3 R = random_rotation(rng);
  return {R, Vec3(0, 0, kArm.d1) + rho * random_rotation(rng).col(2) + kArm.d6 * R.col(2)};
}

TEST(ArmInverse, ForwardUndoesInverseOnRandomPoses) {
  std::mt19937_64 rng(kSeed);
  double worst = 0;
  for (std::size_t n = 0; n < 1000000; ++n) {
    const Pose X = random_pose(rng, reference::uniform(rng, 0.0101, 0.4899));
    const ArmInverse all = inverse_all(kArm, X, kTeleopHome);
    ASSERT_EQ(all.status, Status::ok) << "seed " << kSeed << " pose " << n;
    const Pose back = forward(kArm, all.rows[n % 8]);
    worst = std::max({worst, (back.p - X.p).norm(), (back.R - X.R).cwiseAbs().maxCoeff()});
  }
  std::printf("10^6 random poses: worst %.2e\n", worst);
  EXPECT_LT(worst, 1e-14) << "seed " << kSeed;
}

TEST(ArmInverse, SaysHowFarAPoseIsOutOfReach) {
  std::mt19937_64 rng(kSeed);
  double worst = 0;
  for (int n = 0; n < 100000; ++n) {
    const bool far = n % 2 == 0;
    const double beyond = std::pow(10, reference::uniform(rng, -11, far ? 0 : -2.1));
    const Pose X = random_pose(rng, far ? 0.49 + beyond : 0.01 - beyond);
    const ArmInverse all = inverse_all(kArm, X, kTeleopHome);
    ASSERT_EQ(all.status, far ? Status::too_far : Status::too_close) << beyond;
    ASSERT_EQ(inverse(kArm, kLimits, X, kTeleopHome).miss, all.miss);
    worst = std::max(worst, static_cast<double>(std::abs(all.miss - reference::miss(kArm, X))));
  }
  std::printf("miss distance: worst error %.2e m\n", worst);
  EXPECT_LT(worst, 1e-15) << "seed " << kSeed;
}

TEST(ArmInverse, TheLastPicometreCountsAsTheEdge) {
  for (const double rho : {0.49 + 5e-13, 0.49, 0.01, 0.01 - 5e-13}) {
    const Pose X{Mat3::Identity(), Vec3(rho, 0, kArm.d1 + kArm.d6)};
    const ArmInverse all = inverse_all(kArm, X, kTeleopHome);
    EXPECT_EQ(all.status, Status::ok) << rho;
    EXPECT_EQ(all.miss, 0);
    EXPECT_NEAR(std::abs(all.rows[0][2]), kPi / 2, 1e-7);
    for (const Vec6& q : all.rows) EXPECT_LT((forward(kArm, q).p - X.p).norm(), 1e-12);
  }
}

Vec6 degrees(double a, double b, double c, double d, double e, double f) {
  return joints_from_degrees({a, b, c, d, e, f});
}

TEST(ArmInverse, HomeHasItsEightKnownRows) {
  const ArmInverse all = inverse_all(kArm, forward(kArm, kTeleopHome), kTeleopHome);
  const std::array<Vec6, 8> expected = {degrees(90, 95, -35, 0, 30, 0),
                                        degrees(90, 95, -35, 180, -30, 180),
                                        degrees(90, -25.509884, -145, 180, 99.490116, 180),
                                        degrees(90, -25.509884, -145, 0, -99.490116, 0),
                                        degrees(-90, -154.490116, -35, 0, 99.490116, 180),
                                        degrees(-90, -154.490116, -35, 180, -99.490116, 0),
                                        degrees(-90, 85, -145, 180, 30, 0),
                                        degrees(-90, 85, -145, 0, -30, 180)};
  for (std::size_t i = 0; i < 8; ++i)
    for (int j = 0; j < 6; ++j)
      EXPECT_LT(std::abs(std::remainder(all.rows[i][j] - expected[i][j], 2 * kPi)), 2e-8)
          << "row " << i << " joint " << j + 1;
}

// The nearest row against section 7.2 in long double on the same pose: what the doubles of
// inverse() themselves cost, in the only branch the reference knows.
TEST(ArmInverse, ErrsByRoundingOverTheMeasuresOnly) {
  std::mt19937_64 rng(kSeed);
  double worst = 0;
  for (int n = 0; n < 100000; ++n) {
    const Vec6 q = reference::random_joints(rng);
    const ArmKinematics k = kinematics(kArm, q);
    if (k.r < 0 || k.cos_q3 < 0 || k.sin_q5 < 0) continue;
    const auto exact = reference::working_row(kArm, k.X_SE);
    const Vec6 found = inverse(kArm, kLimits, k.X_SE, q).q;
    const ArmSingularity& m = k.singularity;
    for (std::size_t i = 0; i < 6; ++i) {
      const auto d = std::remainder(found[static_cast<Eigen::Index>(i)] - exact[i],
                                    2 * std::numbers::pi_v<long double>);
      worst = std::max(worst, static_cast<double>(std::abs(d)) * m.wrist * m.elbow * m.shoulder);
    }
  }
  std::printf("nearest against long double: %.2e rad / (sin q5 cos q3 r)\n", worst);
  EXPECT_LT(worst, 1e-15) << "seed " << kSeed;
}

TEST(ArmInverse, RefusesWhatIsNotAPose) {
  const Pose home = forward(kArm, kTeleopHome);
  const auto expect = [](Status s, const ArmGeometry& g, const Pose& X, const Vec6& q) {
    const ArmInverse all = inverse_all(g, X, q);
    EXPECT_EQ(all.status, s);
    for (const Vec6& r : all.rows) EXPECT_EQ(r, Vec6::Zero());
    const ArmNearest nearest = inverse(g, kLimits, X, q);
    EXPECT_EQ(nearest.status, s);
    EXPECT_EQ(nearest.q, q.allFinite() ? q : Vec6(Vec6::Zero()));
  };
  Pose X = home;
  X.p.y() = NAN;
  expect(Status::not_finite, kArm, X, kTeleopHome);
  X = home, X.R(1, 2) = INFINITY;
  expect(Status::not_finite, kArm, X, kTeleopHome);
  expect(Status::not_finite, kArm, home, Vec6::Constant(NAN));
  X = home, X.R *= 1 + 1e-8;
  expect(Status::no_solution, kArm, X, kTeleopHome);
  X = home, X.R.col(0) = -X.R.col(0);
  expect(Status::no_solution, kArm, X, kTeleopHome);
  expect(Status::no_solution, {.a2 = 0}, home, kTeleopHome);
  expect(Status::not_finite, {.d1 = NAN}, home, kTeleopHome);
  X = home, X.p.x() = 1e300;
  expect(Status::too_far, kArm, X, kTeleopHome);
  EXPECT_TRUE(std::isfinite(inverse_all(kArm, X, kTeleopHome).miss));
}

TEST(ArmInverse, AnArmOfEqualLinksFoldsOntoItsShoulder) {
  const ArmGeometry equal{.a2 = 0.24};
  const Pose X{Mat3::Identity(), Vec3(0, 0, equal.d1 + equal.d6)};
  for (const Vec6& q : inverse_all(equal, X, kTeleopHome).rows) {
    ASSERT_TRUE(q.allFinite());
    EXPECT_LT((forward(equal, q).p - X.p).norm(), 1e-15);
  }
}

}  // namespace
}  // namespace farhand::arm_inverse_test
