#include "master/handle.hpp"

#include <gtest/gtest.h>

namespace farhand {
namespace {

TEST(HandleVelocity, OfASteadyMoveAndTurnIsThatOfThePose) {
  HandleVelocity velocity(60, 0.001);
  const Vec3 v(0.1, -0.2, 0.05), w(0.5, 1.0, -0.3);
  Twist V;
  for (int k = 0; k < 200; ++k) V = velocity.step({rotation(w * (0.001 * k)), v * (0.001 * k)});
  EXPECT_NEAR((V.linear - v).norm(), 0, 1e-12);
  EXPECT_NEAR((V.angular - w).norm(), 0, 1e-6);  // the small-angle difference, third order
}

TEST(HandleVelocity, StartsAtRest) {
  HandleVelocity velocity(60, 0.001);
  EXPECT_EQ(velocity.step({Mat3::Identity(), Vec3(1, 2, 3)}).linear, Vec3::Zero());
}

TEST(Handle, GivesNoForceOutsideTheAcceptedWorkspace) {
  Handle handle = FalconHandle{};
  const Vec3 edge(0.0, 0.0, 0.0622);  // reachable, and as good as stretched
  Vec6 theta = Vec6::Zero();
  theta.head<3>() = motor_angles(kFalconTable1, edge).theta1;
  HandlePose at;
  update(handle, theta, at);
  ASSERT_EQ(at.status, Status::ok);
  EXPECT_EQ(map_forces(handle, at), Status::out_of_limits);
  at.X_MH.p = Vec3(0, 0, 0.12);
  theta.head<3>() = motor_angles(kFalconTable1, at.X_MH.p).theta1;
  update(handle, theta, at);
  EXPECT_EQ(map_forces(handle, at), Status::ok);
}

TEST(Handle, TheTwinDeltasTwistIsPartOfItsPose) {
  Handle handle = TwinDeltaHandle{};
  for (double gamma : {-3.0, -1.0, 0.0, 2.0}) {
    const Vec6 theta = motor_angles(kTwinDelta, {.length = twist_length(kTwinDelta, gamma)}).theta1;
    HandlePose at;
    update(handle, theta, at);
    ASSERT_EQ(at.status, Status::ok);
    EXPECT_NEAR(rotation_vector(at.X_MH.R).z(), gamma, 1e-11);
    EXPECT_NEAR((at.R_MG - Mat3::Identity()).norm(), 0, 1e-12);
  }
}

TEST(Handle, KeepsThePoseAndSaysWhyWhenTheAnglesHaveNone) {
  for (Handle handle : {Handle(FalconHandle{}), Handle(TwinDeltaHandle{})}) {
    HandlePose at{.X_MH = {Mat3::Identity(), Vec3(1, 2, 3)}};
    update(handle, Vec6::Constant(NAN), at);
    EXPECT_EQ(at.status, Status::not_finite);
    EXPECT_EQ(at.X_MH.p, Vec3(1, 2, 3));
  }
}

}  // namespace
}  // namespace farhand
