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

}  // namespace
}  // namespace farhand
