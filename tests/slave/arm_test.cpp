#include "slave/arm.hpp"

#include <gtest/gtest.h>

#include <Eigen/LU>

#include "tests/support/arm_reference.hpp"
#include "tests/support/golden.hpp"

namespace farhand::arm_test {
namespace {

constexpr unsigned kSeed = 7101;
const ArmGeometry kArm;

Eigen::VectorXd wxyz(const Mat3& R) {
  const Quat q = to_quat(R);
  return Eigen::Vector4d(q.w(), q.x(), q.y(), q.z());
}

Mat6 force_first(const ArmJacobian& J) {
  Mat6 out;
  out << J.linear, J.angular;
  return out;
}

void forward_kinematics(const golden::Json& v, golden::Checker& check) {
  const Vec6 q = golden::column(v["in"]["q"]);
  for (const Pose& X_SE : {forward(kArm, q), kinematics(kArm, q).X_SE}) {
    check.values("R", golden::rows(X_SE.R), v["out"]["R"], v["tol"]);
    check.values("p", X_SE.p, v["out"]["p"], v["tol"]);
    const Eigen::VectorXd quat = golden::column(v["out"]["quat_wxyz"]);
    const double sign = quat.dot(wxyz(X_SE.R)) < 0 ? -1 : 1;
    check.values("quaternion", sign * wxyz(X_SE.R), v["out"]["quat_wxyz"], v["tol"]);
  }
}

void jacobian(const golden::Json& v, golden::Checker& check) {
  const ArmKinematics k = kinematics(kArm, golden::column(v["in"]["q"]));
  check.values("J", golden::rows(force_first(k.J)), v["out"]["J"], v["tol"]);
  check.value("r", k.r, v["out"]["r"], v["tol"]);
  check.value("cos q3", k.cos_q3, v["out"]["cos_q3"], v["tol"]);
  check.value("sin q5", k.sin_q5, v["out"]["sin_q5"], v["tol"]);
  const double product = -kArm.a2 * kArm.d4 * k.r * k.cos_q3 * k.sin_q5;
  check.value("det, factored", product, v["out"]["det"], 1e-13);
  check.value("det", force_first(k.J).determinant(), v["out"]["det"], 1e-13);
}

void statics(const golden::Json& v, golden::Checker& check) {
  const Vec6 w = golden::column(v["in"]["wrench_F_M"]);
  const ArmKinematics k = kinematics(kArm, golden::column(v["in"]["q"]));
  check.values("tau", joint_torques(k.J, {.force = w.head<3>(), .torque = w.tail<3>()}),
               v["out"]["tau"], v["tol"]);
}

TEST(Arm, golden) {
  golden::run("serial", {{"fk", forward_kinematics}, {"jacobian", jacobian}, {"static", statics}},
              {"ik", "ik_wrist_singular", "ik_unreachable",  // arm_inverse_test
               "mapping"});                                  // workspace_test
}

TEST(Arm, HomeHoldsTheToolLevelAndForward) {
  const ArmKinematics k = kinematics(kArm, kTeleopHome);
  EXPECT_LT((k.X_SE.p - Vec3(0, 0.32605716122, 0.38904867452)).norm(), 1e-11);
  EXPECT_LT((k.X_SE.R.col(2) - Vec3::UnitY()).norm(), 1e-15);
  EXPECT_LT((k.X_SE.R.col(0) - Vec3::UnitZ()).norm(), 1e-15);
  EXPECT_NEAR(k.singularity.wrist, 0.5, 1e-15);
  EXPECT_NEAR(k.singularity.elbow, std::cos(kTeleopHome[2]), 1e-15);
  EXPECT_NEAR(k.singularity.shoulder, 0.32605716122 - kArm.d6, 1e-11);
}

TEST(Arm, ForwardIsAccurateToRounding) {
  std::mt19937_64 rng(kSeed);
  reference::PoseError worst;
  for (int n = 0; n < 100000; ++n) {
    const Vec6 q = reference::random_joints(rng);
    worst.raise(reference::pose_error(reference::forward(kArm, q), forward(kArm, q)));
  }
  std::printf("forward: worst %.2e m, %.2e in an element of R\n", worst.position, worst.rotation);
  EXPECT_LT(worst.position, 1e-15) << "seed " << kSeed;
  EXPECT_LT(worst.rotation, 1.5e-15) << "seed " << kSeed;
}

TEST(Arm, PoseAndJacobianAloneAreTheSameBitsAsTogether) {
  std::mt19937_64 rng(kSeed);
  for (int n = 0; n < 1000; ++n) {
    const Vec6 q = reference::random_joints(rng);
    const Pose a = forward(kArm, q), b = kinematics(kArm, q).X_SE;
    ASSERT_TRUE(a.R == b.R && a.p == b.p) << "seed " << kSeed;
    const ArmJacobian J = farhand::jacobian(kArm, q), K = kinematics(kArm, q).J;
    ASSERT_TRUE(J.linear == K.linear && J.angular == K.angular) << "seed " << kSeed;
  }
}

// Of the long double product of DH matrices, so that the quotient is good to 1e-12.
Twist difference_quotient(const Vec6& q, Eigen::Index joint, const Mat3& R_SE) {
  Eigen::Matrix<long double, 6, 1> plus = q.cast<long double>(), minus = plus;
  const long double step = 1e-6L;
  plus[joint] += step, minus[joint] -= step;
  const auto a = reference::forward(kArm, plus), b = reference::forward(kArm, minus);
  reference::RealPose slope{};
  for (std::size_t r = 0; r < 3; ++r)
    for (std::size_t c = 0; c < 4; ++c) slope[r][c] = (a[r][c] - b[r][c]) / (2 * step);
  const Pose d = reference::rounded(slope);
  const Mat3 W = d.R * R_SE.transpose();
  return {Vec3(W(2, 1) - W(1, 2), W(0, 2) - W(2, 0), W(1, 0) - W(0, 1)) / 2, d.p};
}

TEST(Arm, JacobianIsTheDerivativeOfThePose) {
  std::mt19937_64 rng(kSeed);
  double worst = 0;
  for (int n = 0; n < 2000; ++n) {
    const Vec6 q = reference::random_joints(rng);
    const ArmKinematics k = kinematics(kArm, q);
    for (Eigen::Index i = 0; i < 6; ++i) {
      const Twist V = difference_quotient(q, i, k.X_SE.R);
      worst = std::max(
          {worst, (V.linear - k.J.linear.col(i)).norm(), (V.angular - k.J.angular.col(i)).norm()});
    }
  }
  std::printf("Jacobian against central differences: worst %.2e\n", worst);
  EXPECT_LT(worst, 1e-11) << "seed " << kSeed;
}

TEST(Arm, TorquesDoTheWorkOfTheWrench) {
  std::mt19937_64 rng(kSeed);
  double worst = 0;
  for (int n = 0; n < 10000; ++n) {
    const ArmJacobian J = kinematics(kArm, reference::random_joints(rng)).J;
    const Wrench F{.force = reference::random_vector(rng, 20),
                   .torque = reference::random_vector(rng, 2)};
    Vec6 dq;
    dq << reference::random_vector(rng, 1), reference::random_vector(rng, 1);
    const Twist V = tool_twist(J, dq);
    worst = std::max(worst, std::abs(joint_torques(J, F).dot(dq) - F.force.dot(V.linear) -
                                     F.torque.dot(V.angular)));
  }
  std::printf("virtual work: worst %.2e W of some 30\n", worst);
  EXPECT_LT(worst, 1e-12) << "seed " << kSeed;
}

// Rounding of the measure in a rate's denominator is what limits a closed form: the residual is
// held against 1 / measure.
TEST(Arm, RatesMoveTheToolAsAsked) {
  std::mt19937_64 rng(kSeed);
  double worst = 0, worst_against_lu = 0;
  for (int n = 0; n < 100000; ++n) {
    const ArmKinematics k = kinematics(kArm, reference::random_joints(rng));
    const Twist V{.angular = reference::random_vector(rng, 1),
                  .linear = reference::random_vector(rng, 1)};
    const JointRates rates = joint_rates(kArm, k, V);
    ASSERT_EQ(rates.status, Status::ok);
    const Twist back = tool_twist(k.J, rates.dq);
    const auto& m = k.singularity;
    const double scale =
        std::min({m.wrist, m.elbow, m.shoulder}) / std::max(1.0, rates.dq.cwiseAbs().maxCoeff());
    worst = std::max({worst, (back.linear - V.linear).norm() * scale,
                      (back.angular - V.angular).norm() * scale});
    if (n % 100 != 0) continue;
    const Vec6 rhs = (Vec6() << V.linear, V.angular).finished();
    const Vec6 lu = force_first(k.J).fullPivLu().solve(rhs);
    worst_against_lu = std::max(worst_against_lu, (lu - rates.dq).norm() * scale);
  }
  std::printf("rates: worst residual %.2e, against LU %.2e (of |dq| / measure)\n", worst,
              worst_against_lu);
  EXPECT_LT(worst, 1e-15) << "seed " << kSeed;
  EXPECT_LT(worst_against_lu, 1e-14) << "seed " << kSeed;
}

TEST(Arm, RatesAreRefusedInASingularityAndOnBadInput) {
  const Twist V{.angular = Vec3::UnitX(), .linear = Vec3::UnitY()};
  Vec6 over_axis = joints_from_degrees({90, 0, 0, 10, 30, 20});
  over_axis[1] = std::atan2(-kArm.a2, kArm.d4);  // r = a2 cos q2 + d4 sin q2 at q3 = 0
  for (const Vec6& q : {joints_from_degrees({90, 95, -35, 10, 0, 20}),
                        joints_from_degrees({90, 95, 90, 10, 30, 20}), over_axis}) {
    const JointRates rates = joint_rates(kArm, kinematics(kArm, q), V);
    EXPECT_EQ(rates.status, Status::singular) << q.transpose();
    EXPECT_EQ(rates.dq, Vec6::Zero()) << q.transpose();
  }
  EXPECT_EQ(joint_rates(kArm, kinematics(kArm, kTeleopHome), V).status, Status::ok);
  const Twist bad{.angular = Vec3::Zero(), .linear = Vec3::Constant(NAN)};
  EXPECT_EQ(joint_rates(kArm, kinematics(kArm, kTeleopHome), bad).status, Status::not_finite);
  EXPECT_EQ(joint_rates(kArm, ArmKinematics{}, V).status, Status::not_finite);
}

TEST(Arm, NonFiniteJointsGiveAStatusAndNoNumbers) {
  Vec6 q = kTeleopHome;
  q[3] = NAN;
  const ArmKinematics k = kinematics(kArm, q);
  EXPECT_EQ(k.status, Status::not_finite);
  EXPECT_EQ(k.X_SE.R, Mat3::Identity());
  EXPECT_EQ(k.J.linear.cwiseAbs().maxCoeff(), 0);
}

}  // namespace
}  // namespace farhand::arm_test
