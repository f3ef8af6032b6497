#include "master/falcon.hpp"

#include <gtest/gtest.h>

#include "tests/support/differences.hpp"
#include "tests/support/golden.hpp"

namespace farhand {
namespace {

using support::derivative, support::in_ball, support::on_sphere;

const Vec3 kCentre(0, 0, 0.120);
constexpr double kBall = 0.055;

FalconGeometry preset(const golden::Json& in) {
  const std::map<std::string, FalconGeometry> presets{{"table1", kFalconTable1},
                                                      {"table1_s0", kFalconTable1S0},
                                                      {"table1_flip", kFalconTable1Flip},
                                                      {"libnifalcon", kFalconLibnifalcon},
                                                      {"spheric", kFalconSpheric}};
  return presets.at(in["geometry"].get<std::string>());
}

void inverse_kinematics(const golden::Json& v, golden::Checker& check) {
  const FalconGeometry g = preset(v["in"]);
  const Vec3 p = golden::column(v["in"]["P"]);
  const FalconInverse ik = inverse(g, p);
  ASSERT_EQ(ik.status, Status::ok) << check.where();
  check.angles("theta1", ik.theta1, v["out"]["theta1"], v["tol"]);
  check.angles("theta1 fast", motor_angles(g, p).theta1, v["out"]["theta1"], v["tol"]);
  check.angles("theta2", ik.theta2, v["out"]["theta2"], v["tol"]);
  check.angles("theta3", ik.theta3, v["out"]["theta3"], v["tol"]);
  check.angles("theta1_other", ik.theta1_other, v["out"]["theta1_other"], 1e-6);

  const FalconJacobian J = jacobian(g, p);
  ASSERT_EQ(J.status, Status::ok) << check.where();
  Mat3 direct;
  for (int i = 0; i < 3; ++i) direct.col(i) = velocity(J, Vec3::Unit(i));
  check.values("Jinv", golden::rows(inverse_jacobian(J)), v["out"]["Jinv"], v["tol_Jinv"]);
  check.values("J", golden::rows(direct), v["out"]["J"], v["tol_J"]);
  check.value("det_n", J.det_n, v["out"]["det_n"], v["tol"]);
}

void unreachable(const golden::Json& v, golden::Checker& check) {
  const FalconGeometry g = preset(v["in"]);
  const Vec3 p = golden::column(v["in"]["P"]);
  const FalconInverse ik = inverse(g, p);
  EXPECT_NE(ik.status, Status::ok) << check.where();
  EXPECT_EQ(motor_angles(g, p).status, ik.status) << check.where();
  EXPECT_EQ(jacobian(g, p).status, ik.status) << check.where();
  for (size_t i = 0; i < 3; ++i) {
    std::string name = to_string(ik.legs[i]);
    std::replace(name.begin(), name.end(), ' ', '_');
    EXPECT_EQ(name, v["out"]["legs"][i].get<std::string>()) << check.where() << " leg " << i;
  }
}

void one_leg(const golden::Json& v, golden::Checker& check) {
  const FalconLeg leg = leg_inverse(preset(v["in"]), golden::column(v["in"]["uvw"]));
  ASSERT_EQ(leg.status, Status::ok) << check.where();
  check.angle("theta1", leg.theta1, v["out"]["theta1"], v["tol"]);
  check.angle("theta2", leg.theta2, v["out"]["theta2"], v["tol"]);
  check.angle("theta3", leg.theta3, v["out"]["theta3"], v["tol"]);
  check.angle("theta1_other", leg.theta1_other, v["out"]["theta1_other"], 1e-6);
}

void forward_kinematics(const golden::Json& v, golden::Checker& check) {
  const FalconGeometry g = preset(v["in"]);
  const Vec3 theta1 = golden::column(v["in"]["theta1"]);
  const FalconForward cold = forward(g, theta1);
  ASSERT_EQ(cold.status, Status::ok) << check.where();
  check.values("P", cold.p_MH, v["out"]["P"], v["tol"]);
  const FalconForward warm = forward(g, theta1, cold.p_MH + Vec3(3e-4, -4e-4, 0));
  check.values("P warm", warm.p_MH, v["out"]["P"], v["tol"]);
  check.value("det_n", jacobian(g, cold).det_n, v["out"]["det_n"], v["tol"]);
  const FalconInverse ik = inverse(g, cold.p_MH);
  check.angles("theta2", ik.theta2, v["out"]["theta2"], v["tol"]);
  check.angles("theta3", ik.theta3, v["out"]["theta3"], v["tol"]);
}

void no_assembly(const golden::Json& v, golden::Checker& check) {
  const FalconGeometry g = preset(v["in"]);
  const Vec3 theta1 = golden::column(v["in"]["theta1"]);
  EXPECT_EQ(forward(g, theta1).status, Status::no_solution) << check.where();
  EXPECT_EQ(forward(g, theta1, kCentre).status, Status::no_solution) << check.where();
}

void statics(const golden::Json& v, golden::Checker& check) {
  const FalconJacobian J = jacobian(preset(v["in"]), golden::column(v["in"]["P"]));
  check.values("tau", torque(J, golden::column(v["in"]["F"])), v["out"]["tau_from_F"], v["tol"]);
  check.values("F", force(J, golden::column(v["in"]["tau"])), v["out"]["F_from_tau"], v["tol"]);
}

TEST(Falcon, golden) {
  golden::run("falcon", {{"ik", inverse_kinematics},
                         {"ik_unreachable", unreachable},
                         {"leg_ik", one_leg},
                         {"fk", forward_kinematics},
                         {"fk_none", no_assembly},
                         {"static", statics}});
}

TEST(Falcon, ForwardUndoesInverseEverywhereInTheBall) {
  constexpr std::uint64_t kSeed = 11;
  std::mt19937_64 random(kSeed);
  double position = 0, angle = 0;
  int failures = 0, cold_steps = 0, warm_steps = 0;
  for (int k = 0; k < support::kRandomPoses; ++k) {
    const Vec3 p = kCentre + in_ball(random, kBall);
    const FalconMotorAngles ik = motor_angles(kFalconTable1, p);
    const FalconForward cold = forward(kFalconTable1, ik.theta1);
    const FalconForward warm = forward(kFalconTable1, ik.theta1, p + Vec3(0, 3e-4, 4e-4));
    failures += ik.status != Status::ok || cold.status != Status::ok || warm.status != Status::ok;
    position = std::max({position, (cold.p_MH - p).norm(), (warm.p_MH - p).norm()});
    const Vec3 again = motor_angles(kFalconTable1, cold.p_MH).theta1;
    angle = std::max(angle, (again - ik.theta1).cwiseAbs().maxCoeff());
    cold_steps = std::max(cold_steps, cold.iterations);
    warm_steps = std::max(warm_steps, warm.iterations);
  }
  std::printf("falcon round trip: %d poses, %d failures, %.2g m, %.2g rad, steps %d cold %d warm\n",
              support::kRandomPoses, failures, position, angle, cold_steps, warm_steps);
  EXPECT_EQ(failures, 0) << "seed " << kSeed;
  EXPECT_LE(position, 1e-12) << "seed " << kSeed;
  EXPECT_LE(angle, 1e-12) << "seed " << kSeed;
  EXPECT_LE(cold_steps, 5);
  EXPECT_LE(warm_steps, 4);
}

// theta_dot along each base axis, from differences of the inverse kinematics.
Mat3 measured_inverse_jacobian(const FalconGeometry& g, const Vec3& p, double h) {
  Mat3 J;
  for (int k = 0; k < 3; ++k)
    J.col(k) = derivative<Vec3>(
        [&](double t) { return motor_angles(g, Vec3(p + t * Vec3::Unit(k))).theta1; }, h);
  return J;
}

TEST(Falcon, JacobianIsTheDerivativeOfTheInverse) {
  constexpr std::uint64_t kSeed = 12;
  std::mt19937_64 random(kSeed);
  double worst = 0;
  for (int k = 0; k < 20'000; ++k) {
    const Vec3 p = kCentre + in_ball(random, kBall);
    const Mat3 measured = measured_inverse_jacobian(kFalconTable1, p, 5e-5);
    const Mat3 J = inverse_jacobian(jacobian(kFalconTable1, p));
    worst = std::max(worst, (J - measured).cwiseAbs().maxCoeff() / J.cwiseAbs().maxCoeff());
  }
  std::printf("falcon Jacobian against differences: %.2g relative\n", worst);
  EXPECT_LE(worst, 1e-8) << "seed " << kSeed;
}

TEST(Falcon, MotorsAndHandExchangeTheSamePower) {
  constexpr std::uint64_t kSeed = 13;
  std::mt19937_64 random(kSeed);
  double worst = 0;
  for (int k = 0; k < 20'000; ++k) {
    const FalconJacobian J = jacobian(kFalconTable1, Vec3(kCentre + in_ball(random, kBall)));
    const Vec3 f = on_sphere(random), v = on_sphere(random), tau = torque(J, f);
    const double scale = tau.norm() * theta_rates(J, v).norm();
    worst = std::max(worst, std::abs(tau.dot(theta_rates(J, v)) - f.dot(v)) / std::max(1.0, scale));
    worst =
        std::max({worst, (force(J, tau) - f).norm(), (velocity(J, theta_rates(J, v)) - v).norm()});
  }
  std::printf("falcon virtual work: %.2g\n", worst);
  EXPECT_LE(worst, 1e-12) << "seed " << kSeed;
}

TEST(Falcon, BothWaysToTheJacobianAgree) {
  const Vec3 p(0.02, -0.03, 0.13);
  const FalconForward at = forward(kFalconTable1, motor_angles(kFalconTable1, p).theta1);
  const FalconJacobian a = jacobian(kFalconTable1, p), b = jacobian(kFalconTable1, at);
  EXPECT_LE((inverse_jacobian(a) - inverse_jacobian(b)).cwiseAbs().maxCoeff(), 1e-12);
  EXPECT_NEAR(a.min_abs_sin, b.min_abs_sin, 1e-13);
  const FalconInverse ik = inverse(kFalconTable1, p);
  EXPECT_NEAR(a.min_abs_sin, (ik.theta1 - ik.theta2).array().sin().abs().minCoeff(), 1e-13);
}

// The grid on which the public driver's kinematics were measured: 4 mm over [-60, 60]^2 x [60, 180]
// mm, wherever the encoders stay within 1600 counts.
TEST(Falcon, PublicDriverGridIsSolvedColdAndForcesPointWhereTheyShould) {
  const FalconGeometry& g = kFalconLibnifalcon;
  const double limit = 1600 * theta1_quantum(g);
  int points = 0, failures = 0, steps = 0;
  double position = 0, direction = 0, sum = 0;
  for (int i = -15; i <= 15; ++i)
    for (int j = -15; j <= 15; ++j)
      for (int k = 15; k <= 45; ++k) {
        const Vec3 p(0.004 * i, 0.004 * j, 0.004 * k);
        const FalconMotorAngles ik = motor_angles(g, p);
        if (ik.status != Status::ok) continue;
        if ((ik.theta1.array() - g.angle_offset).abs().maxCoeff() > limit) continue;
        ++points;
        const FalconForward at = forward(g, ik.theta1);
        failures += at.status != Status::ok;
        steps = std::max(steps, at.iterations);
        position = std::max(position, (at.p_MH - p).norm());
        const Vec3 wanted = Vec3(1 + i, 2 - j, 30 - k).normalized();
        const Vec3 tau = torque(jacobian(g, at), wanted);
        const Vec3 felt = measured_inverse_jacobian(g, p, 2e-5).transpose() * tau;
        const double error = support::angle_between(wanted, felt);
        direction = std::max(direction, error);
        sum += error;
      }
  const double degrees = 180 / std::numbers::pi;
  std::printf(
      "falcon grid: %d points, %d failures, at most %d cold steps, round trip %.2g m, force "
      "direction %.2g deg worst, %.2g deg mean\n",
      points, failures, steps, position, direction * degrees, sum / points * degrees);
  EXPECT_NEAR(points, 17'700, 100);
  EXPECT_EQ(failures, 0);
  EXPECT_LE(steps, 5);
  EXPECT_LE(position, 1e-12);
  EXPECT_LE(direction * degrees, 1e-5);
}

TEST(Falcon, CountsFollowThePublishedEncoder) {
  EXPECT_NEAR(theta1_quantum(kFalconLibnifalcon), 0.63590e-3, 5e-9);
  EXPECT_NEAR(theta1_quantum(kFalconTable1), 0.64419e-3, 5e-9);
  const double z[] = {0.0896, 0.1108, 0.1346, 0.1569, 0.1736};
  for (int k = 0; k < 5; ++k) {
    const Eigen::Vector3i counts = Eigen::Vector3i::Constant(500 * (k - 2));
    const Vec3 theta1 = theta1_from_counts(kFalconLibnifalcon, counts);
    EXPECT_NEAR(forward(kFalconLibnifalcon, theta1).p_MH.z(), z[k], 5.1e-5);
    EXPECT_EQ(counts_from_theta1(kFalconLibnifalcon, theta1), counts);
  }
  const Eigen::Vector3i held = counts_from_theta1(kFalconTable1, Vec3(NAN, 1e300, -1e300));
  EXPECT_EQ(held, Eigen::Vector3i(0, 32767, -32768));
}

TEST(Falcon, AcceptedWorkspaceHoldsTheBallAndEndsBeforeTheSingularities) {
  constexpr std::uint64_t kSeed = 14;
  std::mt19937_64 random(kSeed);
  for (int k = 0; k < 20'000; ++k) {
    const Vec3 p = kCentre + in_ball(random, kBall);
    EXPECT_TRUE(accepted(kFalconTable1, jacobian(kFalconTable1, p))) << p.transpose();
  }
  EXPECT_FALSE(accepted(kFalconTable1, jacobian(kFalconTable1, Vec3(0, 0, 0.184))));
  EXPECT_FALSE(accepted(kFalconTable1, jacobian(kFalconTable1, Vec3(0, 0, 0.040))));
  EXPECT_FALSE(accepted(kFalconTable1, jacobian(kFalconTable1, Vec3(0, 0.09, 0.12))));
}

TEST(Falcon, NearTheEdgeTheTorqueGrowsAndBeyondItIsZero) {
  const Vec3 f(0, 0, 1);
  const FalconJacobian inside = jacobian(kFalconTable1, Vec3(0, 0, 0.1842));
  EXPECT_EQ(inside.status, Status::ok);
  EXPECT_TRUE(torque(inside, f).allFinite());
  const FalconJacobian outside = jacobian(kFalconTable1, Vec3(0, 0, 0.190));
  EXPECT_EQ(outside.status, Status::too_far);
  EXPECT_EQ(torque(outside, f), Vec3::Zero());
  EXPECT_EQ(inverse_jacobian(outside), Mat3::Zero());
}

TEST(Falcon, BadInputGivesAStatusAndNoNumbers) {
  const FalconJacobian J = jacobian(kFalconTable1, kCentre);
  for (const double bad : {double(NAN), double(INFINITY), -double(INFINITY)})
    for (int i = 0; i < 3; ++i) {
      Vec3 x = kCentre;
      x[i] = bad;
      EXPECT_EQ(inverse(kFalconTable1, x).status, Status::not_finite);
      EXPECT_EQ(inverse(kFalconTable1, x).theta1, Vec3::Zero());
      EXPECT_EQ(motor_angles(kFalconTable1, x).status, Status::not_finite);
      EXPECT_EQ(leg_inverse(kFalconTable1, x).status, Status::not_finite);
      EXPECT_EQ(jacobian(kFalconTable1, x).status, Status::not_finite);
      EXPECT_EQ(forward(kFalconTable1, x).status, Status::not_finite);
      EXPECT_EQ(forward(kFalconTable1, x, kCentre).p_MH, Vec3::Zero());
      EXPECT_EQ(torque(J, x), Vec3::Zero());
      EXPECT_EQ(force(J, x), Vec3::Zero());
      EXPECT_EQ(theta_rates(J, x), Vec3::Zero());
      EXPECT_EQ(velocity(J, x), Vec3::Zero());
      const Vec3 theta1 = motor_angles(kFalconTable1, kCentre).theta1;
      EXPECT_EQ(forward(kFalconTable1, theta1, x).status, Status::ok);  // started cold
    }
  EXPECT_NE(inverse(kFalconTable1, Vec3::Constant(1e200)).status, Status::ok);
  EXPECT_EQ(jacobian(kFalconTable1, forward(kFalconTable1, Vec3(3, -3, 3))).status,
            Status::no_solution);
}

TEST(Falcon, RandomAnglesNeverGiveNaN) {
  constexpr std::uint64_t kSeed = 15;
  std::mt19937_64 random(kSeed);
  for (int k = 0; k < 100'000; ++k) {
    const Vec3 theta1 = 3.2 * support::in_cube(random);
    const FalconForward at = forward(kFalconTable1, theta1);
    ASSERT_TRUE(at.p_MH.allFinite()) << theta1.transpose() << " seed " << kSeed;
    if (at.status != Status::ok) continue;
    const FalconMotorAngles back = motor_angles(kFalconTable1, at.p_MH);
    ASSERT_EQ(back.status, Status::ok) << theta1.transpose() << " seed " << kSeed;
    const Vec3 off = (back.theta1 - theta1).unaryExpr([](double x) {
      return std::remainder(x, 2 * std::numbers::pi);
    });
    ASSERT_LE(off.cwiseAbs().maxCoeff(), 1e-6) << theta1.transpose() << " seed " << kSeed;
  }
}

}  // namespace
}  // namespace farhand
