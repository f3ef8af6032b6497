#include "master/twin_delta.hpp"

#include <gtest/gtest.h>

#include "tests/support/differences.hpp"
#include "tests/support/golden.hpp"
#include "tests/support/twin_delta_golden.hpp"

namespace farhand::twin_delta_test {
namespace {

using golden::moment_first, golden::twin_delta_jacobian, golden::twin_delta_pose;
using support::derivative, support::in_ball, support::on_sphere, support::uniform;

const Vec3 kHome(0.18, 0, 0);
const TwinDeltaGeometry& kG = kTwinDelta;

// R_h and the angles, where the files compare them.
void orientation(const Vec3& u, const golden::Json& v, golden::Checker& check, double tol) {
  const HandleAngles a = handle_angles(u);
  const auto& out = v["out"];
  check.values("R_h", golden::rows(handle_axes(u)), out["R_h"], tol);
  check.angle("beta_e", a.beta_e, out["beta_e"], tol);
  if (std::hypot(u.y(), u.z()) >= 1e-9) check.angle("alpha_e", a.alpha_e, out["alpha_e"], tol);
  if (std::abs(u.z()) < 1e-9 || !out.contains("alpha")) return;
  check.angle("alpha", a.alpha, out["alpha"], tol);
  check.angle("beta", a.beta, out["beta"], tol);
}

void inverse_kinematics(const golden::Json& v, golden::Checker& check) {
  const TwinDeltaPose pose = twin_delta_pose(v["in"]);
  const TwinDeltaInverse ik = inverse(kG, pose);
  ASSERT_EQ(ik.status, Status::ok) << check.where();
  check.angles("theta1", ik.theta1, v["out"]["theta1"], v["tol"]);
  check.angles("theta1 fast", motor_angles(kG, pose).theta1, v["out"]["theta1"], v["tol"]);
  check.angles("theta2", ik.theta2, v["out"]["theta2"], v["tol"]);
  check.angles("theta3", ik.theta3, v["out"]["theta3"], v["tol"]);
  check.angles("theta1_other", ik.theta1_other, v["out"]["theta1_other"], 1e-6);
  const double gamma = twist_angle(kG, pose.length) + std::numbers::pi;
  check.value("gamma", gamma, v["out"]["gamma"], v["tol"]);
  orientation(pose.axis, v, check, v["tol_R"]);
}

void unreachable(const golden::Json& v, golden::Checker& check) {
  const TwinDeltaPose pose = twin_delta_pose(v["in"]);
  const TwinDeltaInverse ik = inverse(kG, pose);
  EXPECT_NE(ik.status, Status::ok) << check.where();
  EXPECT_EQ(motor_angles(kG, pose).status, ik.status) << check.where();
  EXPECT_EQ(jacobian(kG, pose, Mat3::Identity()).status, ik.status) << check.where();
  for (size_t i = 0; i < 6; ++i) {
    std::string name = to_string(ik.legs[i]);
    std::replace(name.begin(), name.end(), ' ', '_');
    EXPECT_EQ(name, v["out"]["legs"][i].get<std::string>()) << check.where() << " leg " << i;
  }
}

void forward_kinematics(const golden::Json& v, golden::Checker& check) {
  const TwinDeltaForward at = forward(kG, golden::column(v["in"]["theta1"]));
  ASSERT_EQ(at.status, Status::ok) << check.where();
  const auto& out = v["out"];
  check.values("p", at.pose.p_MH, out["p"], v["tol"]);
  check.values("u", at.pose.axis, out["u"], v["tol"]);
  check.value("l", at.pose.length, out["l"], v["tol"]);
  check.values("E1", at.p_ME1, out["E1"], v["tol"]);
  check.values("E2", at.p_ME2, out["E2"], v["tol"]);
  check.value("gamma", twist_angle(kG, at.pose.length) + std::numbers::pi, out["gamma"], v["tol"]);
  const TwinDeltaPassiveAngles passive = passive_angles(kG, at);
  check.angles("theta2", passive.theta2, out["theta2"], v["tol"]);
  check.angles("theta3", passive.theta3, out["theta3"], v["tol"]);
  const TwinDeltaJacobian J = jacobian(kG, at, handle_axes(at.pose.axis));
  check.value("det_Jx1", J.half[0].bars.det, out["det_Jx1"], v["tol"]);
  check.value("det_Jx2", J.half[1].bars.det, out["det_Jx2"], v["tol"]);
  orientation(at.pose.axis, v, check, v["tol_R"]);
}

void no_assembly(const golden::Json& v, golden::Checker& check) {
  const TwinDeltaForward at = forward(kG, golden::column(v["in"]["theta1"]));
  EXPECT_EQ(at.status, Status::no_solution) << check.where();
  EXPECT_EQ(jacobian(kG, at, Mat3::Identity()).status, Status::no_solution);
  EXPECT_EQ(passive_angles(kG, at).theta2, Vec6::Zero());
}

Mat3 half_jacobian(const BarMap& half) {
  Mat3 J;
  for (int k = 0; k < 3; ++k) J.col(k) = theta_rates(half, Vec3::Unit(k));
  return J;
}

void jacobians(const golden::Json& v, golden::Checker& check) {
  const TwinDeltaJacobian J = twin_delta_jacobian(v["in"]);
  ASSERT_EQ(J.status, Status::ok) << check.where();
  const auto& out = v["out"];
  check.values("J1", golden::rows(half_jacobian(J.half[0])), out["J1"], v["tol"]);
  check.values("J2", golden::rows(half_jacobian(J.half[1])), out["J2"], v["tol"]);
  check.value("det_Jx1", J.half[0].bars.det, out["det_Jx1"], v["tol"]);
  check.value("det_Jx2", J.half[1].bars.det, out["det_Jx2"], v["tol"]);
  Mat6 L, Jh, Jh_transposed, back;
  for (int k = 0; k < 6; ++k) {
    const Vec6 unit = Vec6::Unit(k);
    L.col(k) = moment_first(wrench(J, EndForces{unit.head<3>(), unit.tail<3>()}));
    Jh.col(k) = theta_rates(J, Twist{.angular = unit.head<3>(), .linear = unit.tail<3>()});
    Jh_transposed.col(k) = moment_first(wrench(J, unit));
    const EndForces ends = end_forces(J, moment_first(Vec6(L.col(k))));
    back.col(k) << ends.f_E1_M, ends.f_E2_A2;
  }
  check.values("L", golden::rows(L), out["L"], v["tol"]);
  check.values("Jh", golden::rows(Jh), out["Jh"], v["tol"]);
  check.values("Jh from wrenches", golden::rows(Mat6(Jh_transposed.transpose())), out["Jh"],
               v["tol"]);
  EXPECT_LE((back - Mat6::Identity()).cwiseAbs().maxCoeff(), 1e-13) << check.where();
}

void statics(const golden::Json& v, golden::Checker& check) {
  const TwinDeltaJacobian J = twin_delta_jacobian(v["in"]);
  const Vec6 tau = golden::column(v["in"]["tau"]), F_u = golden::column(v["in"]["F_u"]);
  const auto& out = v["out"];
  check.values("F_u", moment_first(wrench(J, tau)), out["F_u_from_tau"], v["tol"]);
  check.values("tau", torque(J, moment_first(F_u)), out["tau_from_F_u"], v["tol_inv"]);
  const EndForces ends = end_forces(J, moment_first(F_u));
  Vec6 F12;
  F12 << ends.f_E1_M, ends.f_E2_A2;
  check.values("F12 from F_u", F12, out["F12_from_F_u"], v["tol_inv"]);
  F12 << force(J.half[0], tau.head<3>()), force(J.half[1], tau.tail<3>());
  check.values("F12 from tau", F12, out["F12_from_tau"], v["tol"]);
}

void projected_angles(const golden::Json& v, golden::Checker& check) {
  const Vec3 u = axis_from_angles(v["in"]["alpha"], v["in"]["beta"]);
  check.values("u", u, v["out"]["u"], v["tol"]);
  const Vec3 E1 = golden::column(v["in"]["p"]) + v["in"]["l"].get<double>() / 2 * u;
  check.values("E1", E1, v["out"]["E1"], v["tol"]);
  orientation(u, v, check, v["tol"]);
}

TEST(TwinDelta, golden) {
  golden::run("sixdof",
              {{"ik", inverse_kinematics},
               {"unreachable", unreachable},
               {"fk", forward_kinematics},
               {"fk_none", no_assembly},
               {"jacobian", jacobians},
               {"static", statics},
               {"angles", projected_angles}},
              {"force_law"});  // master/force_law_test
}

// The dextrous ball: 35 mm about home, any direction not below the horizontal, any length.
TwinDeltaPose dextrous(std::mt19937_64& random) {
  TwinDeltaPose pose{.p_MH = kHome + in_ball(random, 0.035), .axis = on_sphere(random)};
  if (pose.axis.z() < 0) pose.axis = -pose.axis;
  pose.length = uniform(random, kG.l_min, kG.l_max);
  return pose;
}

TEST(TwinDelta, ForwardUndoesInverseEverywhereInTheDextrousBall) {
  constexpr std::uint64_t kSeed = 21;
  std::mt19937_64 random(kSeed);
  double position = 0, axis = 0, motor = 0;
  int failures = 0;
  for (int k = 0; k < support::kRandomPoses; ++k) {
    const TwinDeltaPose pose = dextrous(random);
    const TwinDeltaMotorAngles ik = motor_angles(kG, pose);
    const TwinDeltaForward at = forward(kG, ik.theta1);
    failures += ik.status != Status::ok || at.status != Status::ok;
    position = std::max(
        {position, (at.pose.p_MH - pose.p_MH).norm(), std::abs(at.pose.length - pose.length)});
    axis = std::max(axis, support::angle_between(at.pose.axis, pose.axis));
    const Vec6 again = motor_angles(kG, at.pose).theta1;
    motor = std::max(motor, (again - ik.theta1).cwiseAbs().maxCoeff());
  }
  std::printf(
      "twin delta round trip: %d poses, %d failures, %.2g m, axis %.2g rad, motors %.2g "
      "rad\n",
      support::kRandomPoses, failures, position, axis, motor);
  EXPECT_EQ(failures, 0) << "seed " << kSeed;
  EXPECT_LE(position, 1e-12) << "seed " << kSeed;
  EXPECT_LE(axis, 1e-12) << "seed " << kSeed;
  EXPECT_LE(motor, 1e-12) << "seed " << kSeed;
}

// The pose after moving along one handle freedom by t, on the exact path.
TwinDeltaPose moved(const TwinDeltaPose& pose, const Mat3& R_MG, int freedom, double t) {
  TwinDeltaPose out = pose;
  if (freedom < 2) out.axis = rotation(t * R_MG.col(freedom)) * pose.axis;
  if (freedom == 2) out.length = twist_length(kG, twist_angle(kG, pose.length) + t);
  if (freedom > 2) out.p_MH += t * R_MG.col(freedom - 3);
  return out;
}

TEST(TwinDelta, RatesAreTheDerivativeOfTheInverse) {
  constexpr std::uint64_t kSeed = 22;
  std::mt19937_64 random(kSeed);
  double worst = 0;
  for (int k = 0; k < 5'000; ++k) {
    const TwinDeltaPose pose = dextrous(random);
    const Mat3 R_MG = handle_axes(pose.axis);
    const TwinDeltaJacobian J = jacobian(kG, pose, R_MG);
    for (int i = 0; i < 6; ++i) {
      const Vec6 unit = Vec6::Unit(i);
      const Vec6 rates = theta_rates(J, Twist{unit.head<3>(), unit.tail<3>()});
      const Vec6 measured = derivative<Vec6>(
          [&](double t) { return motor_angles(kG, moved(pose, R_MG, i, t)).theta1; }, i == 2 ? 2e-2
                                                                                      : i < 2
                                                                                          ? 2e-3
                                                                                          : 2e-4);
      worst = std::max(worst, (rates - measured).norm() / rates.norm());
    }
  }
  std::printf("twin delta Jacobian against differences: %.2g relative\n", worst);
  EXPECT_LE(worst, 1e-8) << "seed " << kSeed;
}

double power(const Wrench& F, const Twist& V) {
  return F.force.dot(V.linear) + F.torque.dot(V.angular);
}

TEST(TwinDelta, MotorsAndHandExchangeTheSamePower) {
  constexpr std::uint64_t kSeed = 23;
  std::mt19937_64 random(kSeed);
  double work = 0, back = 0;
  for (int k = 0; k < 20'000; ++k) {
    const TwinDeltaPose pose = dextrous(random);
    const TwinDeltaJacobian J = jacobian(kG, pose, handle_axes(pose.axis));
    const Wrench F{10 * on_sphere(random), 0.1 * on_sphere(random)};
    const Twist V{on_sphere(random), 0.2 * on_sphere(random)};
    const Vec6 tau = torque(J, F), rates = theta_rates(J, V);
    work = std::max(work, std::abs(tau.dot(rates) - power(F, V)) / (tau.norm() * rates.norm()));
    const Twist V2 = velocity(J, rates);
    const Wrench F2 = wrench(J, tau);
    back = std::max({back, (V2.linear - V.linear).norm(), (V2.angular - V.angular).norm(),
                     (F2.force - F.force).norm() / 10, (F2.torque - F.torque).norm()});
  }
  std::printf("twin delta virtual work: %.2g, there and back %.2g\n", work, back);
  EXPECT_LE(work, 1e-12) << "seed " << kSeed;
  EXPECT_LE(back, 1e-12) << "seed " << kSeed;
}

TEST(TwinDelta, BothWaysToTheJacobianAgree) {
  constexpr std::uint64_t kSeed = 24;
  std::mt19937_64 random(kSeed);
  for (int k = 0; k < 1'000; ++k) {
    const TwinDeltaPose pose = dextrous(random);
    const Mat3 R_MG = handle_axes(pose.axis);
    const Wrench F{on_sphere(random), on_sphere(random)};
    const Vec6 a = torque(jacobian(kG, pose, R_MG), F);
    const Vec6 b = torque(jacobian(kG, forward(kG, motor_angles(kG, pose).theta1), R_MG), F);
    EXPECT_LE((a - b).norm(), 1e-12 * a.norm()) << "seed " << kSeed;
  }
}

TEST(TwinDelta, HomeCarriesThirtyNewtonAndTwoNewtonMetres) {
  const TwinDeltaPose home{.length = 0.14};
  const TwinDeltaJacobian J = jacobian(kG, home, handle_axes(home.axis));
  EXPECT_TRUE(accepted(kG, J));
  double torque_for_force = 0, torque_for_moment = 0;
  for (int i = 0; i < 360; ++i) {
    const double a = i * std::numbers::pi / 180;
    const Vec3 across(std::cos(a), std::sin(a), 0);
    torque_for_force =
        std::max(torque_for_force, torque(J, {.force = 30 * across}).cwiseAbs().maxCoeff());
    torque_for_moment =
        std::max(torque_for_moment, torque(J, {.torque = 2 * across}).cwiseAbs().maxCoeff());
  }
  EXPECT_LE(torque_for_force, 3.0);
  EXPECT_LE(torque_for_moment, 2.0);
  EXPECT_GT(torque_for_force, 1.0);
  EXPECT_GT(torque_for_moment, 1.0);
}

TEST(TwinDelta, AMeasuredScrewChangesForcesButNotVelocities) {
  const TwinDeltaPose home;
  const TwinDeltaGeometry measured{.k = 2 * kG.k};
  const TwinDeltaJacobian a = jacobian(kG, home, Mat3::Identity());
  const TwinDeltaJacobian b = jacobian(measured, home, Mat3::Identity());
  const Vec6 tau = Vec6::LinSpaced(-1, 1);
  EXPECT_NEAR(wrench(b, tau).torque.z(), 2 * wrench(a, tau).torque.z(), 1e-15);
  EXPECT_EQ(velocity(a, tau).angular.z(), velocity(b, tau).angular.z());
}

TEST(TwinDelta, TwistIsCentredAndComesBack) {
  EXPECT_NEAR(twist_angle(kG, 0.14), -std::numbers::pi, 1e-14);
  EXPECT_NEAR(twist_angle(kG, 0.17), 0, 1e-14);
  EXPECT_NEAR(twist_angle(kG, 0.20), std::numbers::pi, 1e-14);
  for (const double l : {0.14, 0.155, 0.2})
    EXPECT_NEAR(twist_length(kG, twist_angle(kG, l)), l, 1e-16);
}

TEST(TwinDelta, HandleAxesAreARotationInEveryDirection) {
  constexpr std::uint64_t kSeed = 25;
  std::mt19937_64 random(kSeed);
  for (int k = 0; k < 10'000; ++k) {
    const Vec3 u = on_sphere(random);
    const double length = uniform(random, kG.l_min, kG.l_max);
    const Mat3 R_MH = handle_rotation(kG, handle_axes(u), length);
    EXPECT_LE((R_MH.transpose() * R_MH - Mat3::Identity()).norm(), 1e-14) << "seed " << kSeed;
    EXPECT_NEAR(R_MH.determinant(), 1, 1e-14) << "seed " << kSeed;
    EXPECT_EQ(R_MH.col(2), u);
    const Mat3 twisted = handle_axes(u) * rotation(Vec3(0, 0, twist_angle(kG, length)));
    EXPECT_LE((R_MH - twisted).norm(), 1e-14) << "seed " << kSeed;
    const HandleAngles a = handle_angles(u);
    const Mat3 euler = rotation(Vec3(a.alpha_e, 0, 0)) * rotation(Vec3(0, a.beta_e, 0));
    EXPECT_LE((handle_axes(u) - euler).norm(), 1e-14) << "seed " << kSeed;
  }
}

TEST(TwinDelta, AlongXTheLastHandleAxesAreHeld) {
  for (const Vec3& u : {Vec3(1, 0, 0), Vec3(-1, 0, 0), Vec3(1, 1e-12, -1e-12)}) {
    const Vec3 previous = Vec3(1e-7, 0.6, -0.8).normalized();
    const Mat3 R = handle_axes(u, previous);
    EXPECT_LE((R.col(0) - previous).norm(), 2e-7);
    EXPECT_LE((R.transpose() * R - Mat3::Identity()).norm(), 1e-11);
    EXPECT_NEAR(R.determinant(), 1, 1e-11);
    const Mat3 no_help = handle_axes(u, u);
    EXPECT_TRUE(no_help.allFinite());
    EXPECT_LE((no_help.transpose() * no_help - Mat3::Identity()).norm(), 1e-11);
  }
}

TEST(TwinDelta, TheDextrousBallIsAcceptedUpToItsLimits) {
  constexpr std::uint64_t kSeed = 26;
  std::mt19937_64 random(kSeed);
  for (int k = 0; k < 20'000; ++k) {
    const TwinDeltaPose pose = dextrous(random);
    const TwinDeltaJacobian J = jacobian(kG, pose, handle_axes(pose.axis));
    const double tilt = std::abs(handle_angles(pose.axis).beta_e) * 180 / std::numbers::pi;
    EXPECT_EQ(accepted(kG, J), tilt <= 85) << tilt << " deg, seed " << kSeed;
  }
}

TEST(TwinDelta, EveryLimitOfTheAcceptedWorkspaceRefusesByItself) {
  const auto at = [](const TwinDeltaPose& pose) {
    return jacobian(kG, pose, handle_axes(pose.axis));
  };
  EXPECT_FALSE(accepted(kG, at({.length = 0.139})));
  EXPECT_FALSE(accepted(kG, at({.length = 0.201})));
  EXPECT_FALSE(accepted(kG, at({.p_MH = {0.5, 0, 0}})));
  const TwinDeltaJacobian flat = at({.p_MH = {0.06, 0, 0.1}});
  EXPECT_EQ(flat.status, Status::ok);
  EXPECT_LT(flat.half[0].bars.det, 0.15);
  EXPECT_GT(flat.half[0].lever.cwiseAbs().minCoeff(), 0.02);
  EXPECT_FALSE(accepted(kG, flat));
  const TwinDeltaJacobian folded = at({.p_MH = {0.026, 0, 0}});
  EXPECT_EQ(folded.status, Status::ok);
  EXPECT_GT(folded.half[0].bars.det, 0.15);
  EXPECT_LT(folded.half[0].lever.cwiseAbs().minCoeff(), 0.02);
  EXPECT_FALSE(accepted(kG, folded));
}

TEST(TwinDelta, KneesOnTheOtherSideAreSolvedButNotAccepted) {
  const TwinDeltaInverse ik = inverse(kG, {});
  const TwinDeltaForward at = forward(kG, ik.theta1_other);
  ASSERT_EQ(at.status, Status::ok);
  EXPECT_FALSE(accepted(kG, jacobian(kG, at, handle_axes(at.pose.axis))));
}

TEST(TwinDelta, BadInputGivesAStatusAndNoNumbers) {
  const TwinDeltaJacobian J = jacobian(kG, TwinDeltaPose{}, Mat3::Identity());
  const Vec6 theta1 = motor_angles(kG, {}).theta1;
  for (const double bad : {double(NAN), double(INFINITY)}) {
    for (const TwinDeltaPose& pose :
         {TwinDeltaPose{.p_MH = {bad, 0, 0}}, TwinDeltaPose{.axis = {0, bad, 1}},
          TwinDeltaPose{.length = bad}}) {
      EXPECT_EQ(inverse(kG, pose).status, Status::not_finite);
      EXPECT_EQ(motor_angles(kG, pose).status, Status::not_finite);
      EXPECT_EQ(jacobian(kG, pose, Mat3::Identity()).status, Status::not_finite);
    }
    for (int i = 0; i < 6; ++i) {
      Vec6 x = theta1;
      x[i] = bad;
      EXPECT_EQ(forward(kG, x).status, Status::not_finite);
      EXPECT_EQ(velocity(J, x).linear, Vec3::Zero());
      EXPECT_EQ(wrench(J, x).force, Vec3::Zero());
      EXPECT_EQ(torque(J, moment_first(x)), Vec6::Zero());
      EXPECT_EQ(theta_rates(J, Twist{x.head<3>(), x.tail<3>()}), Vec6::Zero());
    }
    EXPECT_EQ(jacobian(kG, forward(kG, theta1), Mat3::Constant(bad)).status, Status::not_finite);
  }
  const TwinDeltaJacobian nothing = jacobian(kG, TwinDeltaPose{.length = 0}, Mat3::Identity());
  EXPECT_EQ(nothing.status, Status::singular);
  EXPECT_EQ(torque(nothing, {.force = Vec3::Ones()}), Vec6::Zero());
  EXPECT_NE(inverse(kG, {.p_MH = Vec3::Constant(1e200)}).status, Status::ok);
}

TEST(TwinDelta, RandomAnglesNeverGiveNaN) {
  constexpr std::uint64_t kSeed = 27;
  std::mt19937_64 random(kSeed);
  for (int k = 0; k < 100'000; ++k) {
    Vec6 theta1;
    for (int i = 0; i < 6; ++i) theta1[i] = uniform(random, -3.2, 3.2);
    const TwinDeltaForward at = forward(kG, theta1);
    ASSERT_TRUE(at.pose.p_MH.allFinite() && at.pose.axis.allFinite()) << "seed " << kSeed;
    if (at.status != Status::ok) continue;
    EXPECT_NEAR(at.pose.axis.norm(), 1, 1e-15);
    const TwinDeltaJacobian J = jacobian(kG, at, handle_axes(at.pose.axis));
    ASSERT_TRUE(torque(J, {Vec3::Ones(), Vec3::Ones()}).allFinite()) << "seed " << kSeed;
  }
}

}  // namespace
}  // namespace farhand::twin_delta_test
