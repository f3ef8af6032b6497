#include "master/force_law.hpp"

#include <gtest/gtest.h>

#include "tests/support/golden.hpp"
#include "tests/support/twin_delta_golden.hpp"

namespace farhand {
namespace {

using golden::moment_first;

Wrench wrench_of(const golden::Json& j) {
  return moment_first(Vec6(golden::column(j)));
}

void published_law(const golden::Json& v, golden::Checker& check) {
  const TwinDeltaJacobian J = golden::twin_delta_jacobian(v["in"]);
  const Wrench K = wrench_of(v["in"]["K_diag"]);
  const Wrench F_u = wrench_of(v["in"]["F_u"]), F_e = wrench_of(v["in"]["F_e"]);
  const Vec6 tau_m = motor_torque(J, K, F_u, F_e), tau_u = torque(J, F_u);
  check.values("tau_m", tau_m, v["out"]["tau_m"], v["tol"]);
  check.values("tau_u", tau_u, v["out"]["tau_u"], v["tol"]);
  check.values("tau_h", tau_m + tau_u, v["out"]["tau_h"], v["tol"]);
}

AxisLoop loop_of(const golden::Json& in) {
  return {.kp = in["kp"],
          .kd = in["kd"],
          .ki = in["ki"],
          .m_d = in["m_d"],
          .B_d = in["B_d"],
          .k_d = in["k_d"],
          .m_u = in["m_u"],
          .b_u = in["b_u"],
          .k_u = in["k_u"],
          .b_e = in["b_e"],
          .k_e = in["k_e"],
          .w_r = in["w_r"],
          .zeta_r = in["zeta_r"],
          .T_delay = in["T_delay"]};
}

void impedance(const golden::Json& v, golden::Checker& check) {
  const AxisResponse r = axis_response(loop_of(v["in"]), v["in"]["omega"]);
  ASSERT_EQ(r.status, Status::ok) << check.where();
  const auto complex = [&](const char* name, const std::complex<double>& z) {
    check.values(name, Eigen::Vector2d(z.real(), z.imag()), v["out"][name], v["tol"]);
  };
  complex("K", r.K);
  complex("S", r.S);
  check.value("reduction", r.reduction, v["out"]["reduction"], v["tol"]);
  complex("Z_h", r.Z_h);
  complex("e_over_X", r.e_over_X);
  complex("Z_closed", r.Z_closed);
  complex("X_over_Fc", r.X_over_Fc);
  complex("Fu_over_Fc", r.Fu_over_Fc);
  complex("Fe_over_Fc", r.Fe_over_Fc);
}

TEST(ForceLaw, golden) {
  // master/twin_delta_test, common/pid_test
  golden::run("sixdof", {{"force_law", published_law}},
              {"ik", "unreachable", "fk", "fk_none", "jacobian", "static", "angles"});
  golden::run("pid", {{"impedance", impedance}},
              {"coeffs", "sequence", "sequence_no_kick", "clamped", "closed_loop"});
}

const Wrench kUser{.force = {1, 2, 3}, .torque = {0.1, 0.2, 0.3}};
const Wrench kGains{.force = {1.2, 0.5, 2}, .torque = {1, 0, 3}};

TEST(ForceLaw, WithoutGainsTheEnvironmentIsReflectedAndTheUserDoesNotMatter) {
  const Wrench F_e{.force = {-4, 0, 5}, .torque = {0.3, 0, -0.1}};
  const Wrench F_m = motor_wrench({}, kUser, F_e);
  EXPECT_EQ(F_m.force, Vec3(-F_e.force));
  EXPECT_EQ(F_m.torque, Vec3(-F_e.torque));
}

TEST(ForceLaw, AtEquilibriumTheMotorsCancelTheUserWhateverTheGains) {
  const TwinDeltaJacobian J = jacobian(kTwinDelta, TwinDeltaPose{}, Mat3::Identity());
  const Vec6 sum = motor_torque(J, kGains, kUser, kUser) + torque(J, kUser);
  EXPECT_LE(sum.cwiseAbs().maxCoeff(), 1e-15);
}

TEST(ForceLaw, InFreeMotionTheMotorsHelpTheUserByTheGain) {
  const FalconJacobian J = jacobian(kFalconTable1, Vec3(0.01, 0.02, 0.12));
  const Vec3 tau = motor_torque(J, kGains, kUser, {});
  EXPECT_LE((force(J, tau) - Vec3(1.2, 1, 6)).norm(), 1e-14);
}

TEST(ForceLaw, BadInputGivesZeroTorque) {
  const TwinDeltaJacobian J = jacobian(kTwinDelta, TwinDeltaPose{}, Mat3::Identity());
  EXPECT_EQ(motor_torque(J, kGains, {.force = {NAN, 0, 0}}, {}), Vec6::Zero());
  EXPECT_EQ(motor_torque(TwinDeltaJacobian{}, kGains, kUser, {}), Vec6::Zero());
  EXPECT_EQ(motor_torque(FalconJacobian{}, kGains, kUser, {}), Vec3::Zero());
}

TEST(ForceLaw, PublishedGainsHideThePublishedShareOfTheDynamics) {
  const AxisLoop loop{.kp = 1.2, .kd = 0.0011, .ki = 0.36, .m_d = 1, .w_r = 1};
  const std::pair<double, double> published[] = {
      {0.02, 0.277}, {0.05, 0.403}, {0.1, 0.440}, {1, 0.4545}, {10, 0.4545}};
  for (const auto& [hertz, felt] : published)
    EXPECT_NEAR(1 - axis_response(loop, 2 * std::numbers::pi * hertz).reduction, felt, 6e-4);
}

TEST(ForceLaw, AFrequencyWithoutAResponseSaysSo) {
  const AxisLoop loop{.kp = 1, .ki = 1, .m_u = 1, .k_u = 4, .w_r = 10, .zeta_r = 1};
  EXPECT_EQ(axis_response(loop, NAN).status, Status::not_finite);
  EXPECT_EQ(axis_response(loop, 0).status, Status::singular);
  EXPECT_EQ(axis_response(loop, -1).status, Status::singular);
  EXPECT_EQ(axis_response(loop, 2).status, Status::singular);  // undamped resonance of the hand
  EXPECT_EQ(axis_response(loop, 3).status, Status::ok);
}

}  // namespace
}  // namespace farhand
