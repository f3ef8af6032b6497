// The arm against KDL, which knows nothing of it but the DH table.
#include <gtest/gtest.h>

#include <cstdio>
#include <kdl/chainfksolverpos_recursive.hpp>
#include <kdl/chainjnttojacsolver.hpp>

#include "tests/support/arm_reference.hpp"
#include "tests/support/kdl_arm.hpp"

namespace farhand {
namespace {

constexpr unsigned kSeed = 7102;
const ArmGeometry kArm;

TEST(ArmOracle, PoseAndJacobianAgreeWithKdl) {
  const KDL::Chain chain = kdl_chain(kArm);
  KDL::ChainFkSolverPos_recursive fk(chain);
  KDL::ChainJntToJacSolver jac(chain);
  std::mt19937_64 rng(kSeed);
  double pose = 0, jacobian = 0;
  for (int n = 0; n < 20000; ++n) {
    KDL::JntArray q(6);
    q.data = reference::random_joints(rng);
    KDL::Frame X;
    KDL::Jacobian J(6);
    ASSERT_GE(fk.JntToCart(q, X), 0);
    ASSERT_GE(jac.JntToJac(q, J), 0);
    const ArmKinematics k = kinematics(kArm, Vec6(q.data));
    for (int i = 0; i < 3; ++i) {
      pose = std::max(pose, std::abs(X.p[i] - k.X_SE.p[i]));
      for (int j = 0; j < 3; ++j) pose = std::max(pose, std::abs(X.M(i, j) - k.X_SE.R(i, j)));
    }
    jacobian = std::max({jacobian, (J.data.topRows<3>() - k.J.linear).cwiseAbs().maxCoeff(),
                         (J.data.bottomRows<3>() - k.J.angular).cwiseAbs().maxCoeff()});
  }
  std::printf("against KDL: pose %.2e, Jacobian %.2e\n", pose, jacobian);
  EXPECT_LT(pose, 1e-14) << "seed " << kSeed;
  EXPECT_LT(jacobian, 1e-14) << "seed " << kSeed;
}

}  // namespace
}  // namespace farhand
