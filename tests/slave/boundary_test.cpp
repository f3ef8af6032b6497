#include "slave/boundary.hpp"

#include <gtest/gtest.h>

#include <random>

namespace farhand::boundary_test {
namespace {

constexpr unsigned kSeed = 11;
const ArmGeometry kArm{};
const JointLimits kJoints{};

// Caps and slews out of the way: the spring itself is looked at.
BoundaryConfig free_spring() {
  BoundaryConfig c;
  c.limits = {
      .force = 1e6, .torque = 1e6, .twist_torque = 1e6, .force_step = 1e6, .torque_step = 1e6};
  return c;
}

Pose moved(const Pose& X, const Vec3& by) {
  return {X.R, X.p + by};
}

double reach(const Vec6& q) {
  return (kinematics(kArm, q).p_S_wrist - Vec3(0, 0, kArm.d1)).norm();
}

TEST(Boundary, InsideItTheWishIsFollowedAndNothingIsFelt) {
  Boundary b({}, kArm, kJoints);
  b.couple(kTeleopHome);
  const Pose wish = moved(forward(kArm, kTeleopHome), Vec3(0.02, 0.03, -0.01));
  const BoundaryHold hold = b.step(wish);
  EXPECT_EQ(hold.status, Status::ok);
  EXPECT_FALSE(hold.held);
  EXPECT_EQ(hold.q, inverse(kArm, kJoints, wish, kTeleopHome).q);
  EXPECT_EQ(hold.X_SE.p, wish.p);
  EXPECT_EQ(b.F_E_S().force, Vec3::Zero());
}

// Beyond the reach the wrist centre stays on the sphere and slides along it; the spring points out.
TEST(Boundary, AtTheReachTheTargetSlidesAndASpringPullsBack) {
  BoundaryConfig config = free_spring();
  config.reach_margin = 0.01;
  Boundary b(config, kArm, kJoints);
  b.couple(kTeleopHome);
  const Pose start = forward(kArm, kTeleopHome);
  Pose wish = start;
  BoundaryHold hold;
  for (int k = 0; k < 300; ++k) hold = b.step(wish = moved(wish, Vec3(0, 0.001, 0)));
  ASSERT_TRUE(hold.held);
  EXPECT_EQ(hold.status, Status::ok);
  EXPECT_NEAR(reach(hold.q), kArm.a2 + kArm.d4 - 0.01, 1e-12);
  const Vec3 stretch = wish.p - hold.X_SE.p;
  const Vec3 out = (kinematics(kArm, hold.q).p_S_wrist - Vec3(0, 0, kArm.d1)).normalized();
  EXPECT_NEAR(stretch.cross(out).norm(), 0, 1e-12);
  EXPECT_NEAR((b.F_E_S().force - config.stiffness * stretch).norm(), 0, 1e-9);
  EXPECT_EQ(b.F_E_S().torque, Vec3::Zero());
  const Vec3 before = hold.X_SE.p;
  for (int k = 0; k < 50; ++k) hold = b.step(wish = moved(wish, Vec3(0, 0, 0.001)));
  EXPECT_GT(hold.X_SE.p.z(), before.z() + 0.01) << "it slides";
  for (int k = 0; k < 300; ++k) hold = b.step(wish = moved(wish, Vec3(0, -0.001, 0)));
  EXPECT_FALSE(hold.held);
  EXPECT_EQ(hold.X_SE.p, wish.p);
  EXPECT_EQ(b.F_E_S().force, Vec3::Zero());
}

// The elbow's margin is a smaller sphere: |cos q3| ends at it, and the other margins are not asked.
TEST(Boundary, TheElbowKeepsItsOwnDistance) {
  for (const double margin : {0.0, 0.3, 0.6}) {
    BoundaryConfig config = free_spring();
    config.elbow_margin = margin;
    Boundary b(config, kArm, kJoints);
    b.couple(kTeleopHome);
    Pose wish = forward(kArm, kTeleopHome);
    BoundaryHold hold;
    for (int k = 0; k < 300; ++k) hold = b.step(wish = moved(wish, Vec3(0, 0.001, 0)));
    EXPECT_NEAR(kinematics(kArm, hold.q).cos_q3, margin, 1e-7);
  }
}

TEST(Boundary, TheWristPassesThroughZeroUnlessItHasAMargin) {
  for (const double margin : {0.0, 0.2}) {
    BoundaryConfig config = free_spring();
    config.wrist_margin = margin;
    Boundary b(config, kArm, kJoints);
    b.couple(kTeleopHome);
    const Vec6 level = joints_from_degrees({90, 95, -35, 0, -20, 0});
    BoundaryHold hold;
    for (int k = 1; k <= 100; ++k)
      hold = b.step(forward(kArm, kTeleopHome + k / 100.0 * (level - kTeleopHome)));
    EXPECT_EQ(hold.held, margin > 0);
    if (margin == 0) {
      EXPECT_NEAR((hold.q - level).norm(), 0, 1e-12);
    } else {
      EXPECT_NEAR(std::sin(hold.q[4]), margin, 1e-12);
      EXPECT_GT(b.F_E_S().torque.norm(), 0.1);
    }
  }
}

// Pushed straight at axis 1, the wrist centre stops before it; pushed a little to the side, it goes
// round, and never through.
TEST(Boundary, TheShoulderIsAPostToGoAround) {
  BoundaryConfig config = free_spring();
  config.shoulder_margin = 0.05;
  Boundary b(config, kArm, kJoints);
  b.couple(kTeleopHome);
  Pose wish = forward(kArm, kTeleopHome);
  const auto r = [](const BoundaryHold& h) {
    return kinematics(kArm, h.q).p_S_wrist.head<2>().norm();
  };
  BoundaryHold hold;
  for (int k = 0; k < 260; ++k) {
    hold = b.step(wish = moved(wish, Vec3(0, -0.001, 0)));
    ASSERT_EQ(hold.status, Status::ok) << k;
    EXPECT_GE(r(hold), 0.05 - 1e-12) << k;
  }
  EXPECT_TRUE(hold.held);
  EXPECT_GT(kinematics(kArm, hold.q).p_S_wrist.y(), 0.04) << "still in front";
  for (int k = 0; k < 60; ++k) {
    hold = b.step(wish = moved(wish, Vec3(-0.001, 0, 0)));
    EXPECT_GE(r(hold), 0.05 - 1e-12) << k;
  }
  // Gone round; the tool's orientation may be beyond the wrist's joints there.
  const Vec3 wish_wrist = wish.p - kArm.d6 * wish.R.col(2);
  EXPECT_NEAR((kinematics(kArm, hold.q).p_S_wrist - wish_wrist).norm(), 0, 1e-9);
}

TEST(Boundary, AJointStopsAtItsLimitWhileTheOthersFollow) {
  BoundaryConfig config = free_spring();
  config.joint_margin = 0.05;
  Boundary b(config, kArm, kJoints);
  b.couple(kTeleopHome);
  Vec6 q = kTeleopHome;
  q[3] = kJoints.upper[3] + 0.2;
  q[0] += 0.3;
  BoundaryHold hold;
  for (int k = 1; k <= 400; ++k)
    hold = b.step(forward(kArm, kTeleopHome + k / 400.0 * (q - kTeleopHome)));
  ASSERT_EQ(hold.status, Status::ok);
  Vec6 expected = q;
  expected[3] = kJoints.upper[3] - 0.05;
  EXPECT_NEAR((hold.q - expected).norm(), 0, 1e-10);
  EXPECT_NEAR((hold.X_SE.p - forward(kArm, hold.q).p).norm(), 0, 1e-15);
  // No other joint feels the spring.
  const Vec6 tau = joint_torques(jacobian(kArm, hold.q), b.F_E_S());
  EXPECT_GT(tau[3], 0.1);
  for (const int i : {0, 1, 2, 4, 5}) EXPECT_NEAR(tau[i], 0, 1e-10) << i;
}

// Along the way that leaves an edge fastest, the edge is as stiff as configured.
TEST(Boundary, AJointsLimitIsAsStiffAsConfigured) {
  const BoundaryConfig config = free_spring();
  Vec6 at = kTeleopHome;
  at[0] = kJoints.upper[0];
  Boundary b(config, kArm, kJoints);
  b.couple(at);
  const double step = 1e-5;
  const Vec3 along = jacobian(kArm, at).linear.col(0).normalized();
  b.step(moved(forward(kArm, at), step * along));
  EXPECT_GT(b.F_E_S().force.dot(along), 0);
  EXPECT_LE(b.F_E_S().force.norm(), config.stiffness * step * 1.001);
}

TEST(Boundary, AnArmCoupledBeyondAnEdgeIsNotMovedAndMayComeIn) {
  BoundaryConfig config = free_spring();
  config.joint_margin = 0.2;
  config.reach_margin = 0.05;
  config.wrist_margin = 0.3;
  Vec6 at = kTeleopHome;
  at[2] = 1.4;  // nearly stretched
  at[4] = 0.1;  // nearly level
  at[0] = kJoints.upper[0] - 0.05;
  Boundary b(config, kArm, kJoints);
  b.couple(at);
  const BoundaryHold hold = b.step(forward(kArm, at));
  EXPECT_NEAR((hold.q - at).norm(), 0, 1e-12);
  EXPECT_NEAR(b.F_E_S().force.norm(), 0, 1e-6);
}

// Random walks of the wish far beyond everything: always an answer within the edges, and the
// wrench within its caps and slews, also while the spring lets go.
TEST(Boundary, WanderingFarOutsideNeverBreaksALimit) {
  std::mt19937 random(kSeed);
  std::normal_distribution<double> normal;
  BoundaryConfig config;
  config.joint_margin = 0.03;
  config.reach_margin = 0.005;
  config.elbow_margin = 0.2;
  config.wrist_margin = 0.1;
  config.shoulder_margin = 0.03;
  Boundary b(config, kArm, kJoints);
  int held = 0;
  Wrench last;
  for (int walk = 0; walk < 40; ++walk) {
    b.couple(kTeleopHome);
    Pose wish = forward(kArm, kTeleopHome);
    Vec3 v = Vec3::Zero(), turn = Vec3::Zero();
    for (int k = 0; k < 1000; ++k) {
      for (int i = 0; i < 3; ++i) v[i] += 1e-4 * normal(random), turn[i] += 5e-4 * normal(random);
      wish = {rotation(turn) * wish.R, wish.p + v};
      v *= 0.98, turn *= 0.98;
      const BoundaryHold hold = b.step(wish);
      ASSERT_EQ(hold.status, Status::ok) << "seed " << kSeed << " walk " << walk << " step " << k;
      held += hold.held;
      const ArmKinematics at = kinematics(kArm, hold.q);
      ASSERT_LE((kJoints.lower - hold.q).maxCoeff(), -0.03 + 1e-12);
      ASSERT_LE((hold.q - kJoints.upper).maxCoeff(), -0.03 + 1e-12);
      ASSERT_GE(at.singularity.wrist, 0.1 - 1e-9);
      ASSERT_GE(at.singularity.elbow, 0.2 - 1e-9);
      ASSERT_LE(b.F_E_S().force.norm(), config.limits.force * (1 + 1e-12));
      ASSERT_LE((b.F_E_S().force - last.force).norm(), config.limits.force_step * (1 + 1e-9));
      ASSERT_LE((b.F_E_S().torque - last.torque).norm(), config.limits.torque_step * (1 + 1e-9));
      last = b.F_E_S();
    }
    for (int k = 0; k < 100; ++k) b.relax();
    EXPECT_EQ(b.F_E_S().force, Vec3::Zero());
    last = {};
  }
  EXPECT_GT(held, 4000);
}

}  // namespace
}  // namespace farhand::boundary_test
