#include "slave/workspace.hpp"

#include <gtest/gtest.h>

#include <limits>

#include "tests/support/golden.hpp"

namespace farhand {
namespace {

// R_H = R_h(u) Rz(gamma - pi), written out here from the reference so that the test does not lean
// on the master.
Mat3 handle_rotation(const Vec3& u_raw, double gamma) {
  const Vec3 u = u_raw.normalized();
  const double n = std::hypot(u.y(), u.z());
  Mat3 R;
  R << n, 0, u.x(), -u.x() * u.y() / n, u.z() / n, u.y(), -u.x() * u.z() / n, -u.y() / n, u.z();
  return R * Eigen::AngleAxisd(gamma - std::numbers::pi, Vec3::UnitZ()).toRotationMatrix();
}

Quat quaternion(const golden::Json& j) {
  return Quat(j[0].get<double>(), j[1].get<double>(), j[2].get<double>(), j[3].get<double>())
      .normalized();
}

void mapping(const golden::Json& v, golden::Checker& check) {
  const auto& in = v["in"];
  const WorkspaceConfig config{.R_SM = twin_delta_axes(), .scale = in["scale"]};
  WorkspaceState state;
  const Pose X_MH0{handle_rotation(golden::column(in["u0_raw"]), in["gamma0"]),
                   golden::column(in["p_h0"])};
  const Pose X_MH{handle_rotation(golden::column(in["u_raw"]), in["gamma"]),
                  golden::column(in["p_h"])};
  couple(config, state, X_MH0,
         {quaternion(in["quat_r0"]).toRotationMatrix(), golden::column(in["p_r0"])});
  LimitSet set = 0;
  const Pose X_SE = follow(config, state, X_MH, set);
  check.values("p_r", X_SE.p, v["out"]["p_r"], v["tol"]);
  check.values("R_r", golden::rows(X_SE.R), v["out"]["R_r"], v["tol"]);
}

TEST(Workspace, golden) {
  golden::run(
      "serial", {{"mapping", mapping}},
      {"fk", "jacobian", "ik", "ik_wrist_singular", "ik_unreachable", "static"});  // slave/arm_test
}

Pose pose(double x, double y, double z, const Vec3& turn = Vec3::Zero()) {
  return {rotation(turn), Vec3(x, y, z)};
}

TEST(Workspace, UsersForwardUpAndRightAreTheRobots) {
  EXPECT_EQ(twin_delta_axes() * Vec3(-1, 0, 0), Vec3(0, 1, 0));
  EXPECT_EQ(twin_delta_axes() * Vec3(0, 0, 1), Vec3(0, 0, 1));
  EXPECT_EQ(twin_delta_axes() * Vec3(0, 1, 0), Vec3(1, 0, 0));
  EXPECT_EQ(falcon_axes() * Vec3(0, 0, -1), Vec3(0, 1, 0));
  EXPECT_EQ(falcon_axes() * Vec3(0, 1, 0), Vec3(0, 0, 1));
  EXPECT_EQ(falcon_axes() * Vec3(1, 0, 0), Vec3(1, 0, 0));
}

TEST(Workspace, CouplingAgainElsewhereDoesNotMoveTheTarget) {
  const WorkspaceConfig config{.R_SM = twin_delta_axes(), .scale = 2};
  WorkspaceState s;
  LimitSet set = 0;
  couple(config, s, pose(0.1, 0, 0), pose(0, 0.3, 0.4));
  const Pose before = follow(config, s, pose(0.12, 0.01, 0, Vec3(0.1, 0, 0)), set);
  uncouple(s, before);
  EXPECT_EQ(follow(config, s, pose(0.2, 0.1, 0.1, Vec3(0, 1, 0)), set).p, before.p);
  const Pose elsewhere = pose(0.15, -0.05, 0.02, Vec3(0, 0, 0.7));
  couple(config, s, elsewhere, before);
  const Pose after = follow(config, s, elsewhere, set);
  EXPECT_EQ(after.p, before.p);
  EXPECT_NEAR((after.R - before.R).norm(), 0, 1e-15);
  EXPECT_EQ(set, kLimitNone);
}

TEST(Workspace, TargetSpeedIsCappedAndCatchesUp) {
  const WorkspaceConfig config{
      .R_SM = Mat3::Identity(), .position_step = 0.001, .rotation_step = 0.01};
  WorkspaceState s;
  couple(config, s, pose(0, 0, 0), pose(0, 0, 0));
  const Pose far = pose(0.0035, 0, 0, Vec3(0, 0, 0.035));
  for (int k = 1; k <= 3; ++k) {
    LimitSet set = 0;
    const Pose X = follow(config, s, far, set);
    EXPECT_EQ(set, kLimitSpeed);
    EXPECT_NEAR(X.p.x(), 0.001 * k, 1e-15);
    EXPECT_NEAR(rotation_vector(X.R).z(), 0.01 * k, 1e-14);
  }
  LimitSet set = 0;
  EXPECT_EQ(follow(config, s, far, set).p, far.p);
  EXPECT_EQ(set, kLimitNone);
}

TEST(Workspace, NonFinitePoseKeepsTheTarget) {
  const Pose turned_to_nowhere{Mat3::Constant(NAN), Vec3::Zero()};
  for (const Pose& bad : {pose(NAN, 0, 0), pose(0, INFINITY, 0), turned_to_nowhere}) {
    WorkspaceState s;
    couple({}, s, pose(0, 0, 0), pose(1, 2, 3));
    LimitSet set = 0;
    EXPECT_EQ(follow({}, s, bad, set).p, Vec3(1, 2, 3));
    EXPECT_EQ(s.X_SE_target.R, Mat3::Identity());
    EXPECT_EQ(set, kLimitNotFinite);
  }
}

// The orientation is kept to the bit, over clutching too, and the torque stays on the robot.
TEST(Workspace, RotationLockKeepsTheToolsOrientation) {
  const WorkspaceConfig config{
      .R_SM = twin_delta_axes(), .scale = 1.5, .rotation_lock = true, .rotation_step = 1e-6};
  const Pose X_SE = pose(0, 0.3, 0.4, Vec3(0.4, -0.2, 1.1));
  WorkspaceState s;
  LimitSet set = 0;
  couple(config, s, pose(0.18, 0, 0, Vec3(0.1, 0, 0)), X_SE);
  Pose X = follow(config, s, pose(0.16, 0, 0.01, Vec3(0, 0.8, 0.3)), set);
  EXPECT_EQ(X.R, X_SE.R);
  EXPECT_NEAR((X.p - (X_SE.p + Vec3(0, 0.03, 0.015))).norm(), 0, 1e-15);
  uncouple(s, X);
  couple(config, s, pose(0.2, 0.05, 0, Vec3(-0.9, 0, 0)), X);
  X = follow(config, s, pose(0.2, 0.06, 0, Vec3(0, 0, 2)), set);
  EXPECT_EQ(X.R, X_SE.R);
  EXPECT_NEAR((X.p - (X_SE.p + Vec3(0.015, 0.03, 0.015))).norm(), 0, 1e-15);
  EXPECT_EQ(set, kLimitNone);
  const Wrench F = reflect(config, {Vec3(1, 2, 3), Vec3(0.1, 0.2, 0.3)});
  EXPECT_EQ(F.force, Vec3(-2, 1, 3));
  EXPECT_EQ(F.torque, Vec3::Zero());
}

// By the first coupling, over later ones, each of them some degrees off, and until it is forgotten.
TEST(Workspace, TheHandleParallelToTheToolIsThatOfTheFirstCoupling) {
  constexpr int kCouplings = 20;
  // Each multiplies what came before some ten times, rounded.
  constexpr double kRounding = 10 * kCouplings * std::numeric_limits<double>::epsilon();
  const WorkspaceConfig config{.R_SM = twin_delta_axes(), .alignment = 0.2};
  WorkspaceState s;
  LimitSet set = 0;
  const Pose X_SE = pose(0, 0.3, 0.4, Vec3(0.4, -0.2, 1.1));
  uncouple(s, X_SE);
  EXPECT_FALSE(parallel_handle(config, s));
  Pose X_MH = pose(0.18, 0, 0, Vec3(0.1, 0.3, -0.2));
  const Mat3 R_MH0 = X_MH.R;
  couple(config, s, X_MH, X_SE);
  for (int k = 1; k <= kCouplings; ++k) {
    X_MH.R = rotation(Vec3(0.02, 0.03, -0.01)) * X_MH.R;
    const Pose X = follow(config, s, X_MH, set);
    EXPECT_FALSE(parallel_handle(config, s));
    uncouple(s, X);
    const Mat3 turned = config.R_SM.transpose() * X.R * X_SE.R.transpose() * config.R_SM;
    const Mat3 back = *parallel_handle(config, s) * (turned * R_MH0).transpose();
    EXPECT_LT(rotation_vector(back).norm(), kRounding) << k;
    X_MH.R = rotation(Vec3(0, 0.1, 0)) * *parallel_handle(config, s);
    couple(config, s, X_MH, X);
    EXPECT_LT(rotation_vector(follow(config, s, X_MH, set).R * X.R.transpose()).norm(), kRounding);
  }
  uncouple(s, X_SE);
  forget_orientation(s);
  EXPECT_FALSE(parallel_handle(config, s));
  couple(config, s, X_MH, X_SE);
  uncouple(s, X_SE);
  EXPECT_LT(rotation_vector(*parallel_handle(config, s) * X_MH.R.transpose()).norm(), kRounding);
}

TEST(Workspace, PowerAgreesOnBothSidesWhenForceAndMotionScalesAreEqual) {
  const WorkspaceConfig config{.R_SM = falcon_axes(), .scale = 1, .force_scale = 1};
  WorkspaceState s;
  couple(config, s, pose(0, 0, 0), pose(0, 0, 0));
  LimitSet set = 0;
  const Vec3 v_H(0.01, -0.02, 0.03);
  const Pose X = follow(config, s, {Mat3::Identity(), v_H}, set);
  const Wrench F{Vec3(1, 2, 3), Vec3::Zero()};
  EXPECT_NEAR(reflect(config, F).force.dot(v_H), F.force.dot(X.p), 1e-17);
}

}  // namespace
}  // namespace farhand
