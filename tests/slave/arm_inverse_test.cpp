#include <gtest/gtest.h>

#include <numbers>

#include "slave/arm.hpp"
#include "tests/support/arm_reference.hpp"
#include "tests/support/golden.hpp"

namespace farhand {
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
    check.angles("q", row(all, branch(s, s["wrist"])), s["q"], v["tol"]);
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
  EXPECT_EQ(all.status, v["out"]["reason"] == "too_far" ? Status::too_far : Status::too_close)
      << check.where();
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

TEST(ArmInverse, PassesThroughTheWristSingularityWithoutATurn) {
  for (const double nearest : {0.0, 1e-8, 1e-6, 3e-4}) {
    const Passage p = worst_passage(0, nearest * 1e3L, nearest);
    EXPECT_LT(p.excess, 1e-7) << nearest;
    EXPECT_LT(p.deviation, 1e-13) << nearest;
  }
  EXPECT_LT(worst_passage(0, 1e-6L, 1e-9).excess, 1e-15 / 1e-9);
}

TEST(ArmInverse, PassesBesideTheWristSingularityWithoutATurn) {
  for (const double nearest : {1e-6, 1e-4, 3e-4}) {
    const Passage p = worst_passage(1e-9L, nearest * 1e3L, nearest);
    EXPECT_LT(p.excess, 1e-7) << nearest;
    EXPECT_LT(p.deviation, 1e-11) << nearest;
  }
}

// Then the path itself takes two quarter turns of q4 and q6, and the second may as well go the
// other way round: equal but for what else q4 and q6 do in that sample (1e-3).
TEST(ArmInverse, ASampleAtTheClosestPointTurnsNoMoreThanThePath) {
  const Passage p = worst_passage(1e-9L, 0, 1e-9);
  EXPECT_LT(p.excess, 1.01e-3);
  EXPECT_LT(std::min(p.deviation, std::abs(p.deviation - kPi)), 1e-11);
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

TEST(ArmInverse, KeepsShoulderElbowAndWristInMotion) {
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

TEST(ArmInverse, UnwrapsTheLastJointUpToItsLimitAndThenHolds) {
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

TEST(ArmInverse, AJointOnItsLimitIsWithinIt) {
  for (const Vec6& q : {kLimits.lower, kLimits.upper}) {
    const ArmNearest found = inverse(kArm, kLimits, forward(kArm, q), q);
    ASSERT_EQ(found.status, Status::ok);
    EXPECT_LT((found.q - q).norm(), 2e-14);
    EXPECT_TRUE((found.q.array() >= kLimits.lower.array()).all());
    EXPECT_TRUE((found.q.array() <= kLimits.upper.array()).all());
  }
}

TEST(ArmInverse, AxesInLineKeepTheFourthJoint) {
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

TEST(ArmInverse, AWristCentreOnAxisOneKeepsTheFirstJoint) {
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
TEST(ArmInverse, AStretchedElbowComesBackOnItsOwnSide) {
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
}  // namespace farhand
