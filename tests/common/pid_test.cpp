#include "common/pid.hpp"

#include <gtest/gtest.h>

#include "tests/support/golden.hpp"

namespace farhand {
namespace {

PidConfig gains(const golden::Json& in) {
  return {.kp = in.at("Kp").get<double>(),
          .ki = in.at("Ki").get<double>(),
          .kd = in.at("Kd").get<double>()};
}

template <typename Step>
Eigen::VectorXd sequence(const golden::Json& in, Step&& step_once) {
  Eigen::VectorXd e = golden::column(in.at("e"));
  return e.unaryExpr(std::forward<Step>(step_once));
}

void coefficients(const golden::Json& v, golden::Checker& check) {
  const IncrementalPid p = make_incremental_pid(gains(v["in"]), v["in"]["Ts"]);
  check.value("a", p.a, v["out"]["a"], v["tol"]);
  check.value("b", p.b, v["out"]["b"], v["tol"]);
  check.value("c", p.c, v["out"]["c"], v["tol"]);
}

void with_history(const golden::Json& v, golden::Checker& check, bool kick) {
  const PidConfig config = gains(v["in"]);
  const double Ts = v["in"]["Ts"];
  const Pid pid = make_pid(config, Ts);
  PidState state{.primed = kick};
  check.values("positional u", sequence(v["in"], [&](double e) { return step(pid, state, e, 0); }),
               v["out"]["u"], v["tol"]);
  IncrementalPid inc = make_incremental_pid(config, Ts);
  if (!kick) start(inc, config, v["in"]["e"][0]);
  check.values("incremental u", sequence(v["in"], [&](double e) { return step(inc, e); }),
               v["out"]["u"], v["tol"]);
}

void clamped(const golden::Json& v, golden::Checker& check) {
  PidConfig config = gains(v["in"]);
  config.limit = v["in"]["u_max"];
  const Pid pid = make_pid(config, v["in"]["Ts"]);
  PidState state;
  std::vector<double> integral;
  const auto u = sequence(v["in"], [&](double e) {
    const double out = step(pid, state, e, 0);
    integral.push_back(state.I);
    return out;
  });
  check.values("u", u, v["out"]["u"], v["tol"]);
  check.values("I", Eigen::Map<Eigen::VectorXd>(integral.data(), u.size()), v["out"]["I"],
               v["tol"]);
}

void closed_loop(const golden::Json& v, golden::Checker& check) {
  const auto& in = v["in"];
  const double Ts = in["Ts"], m = in["m"], B = in["B"], r = in["r"];
  const double q = std::exp(-B * Ts / m), c = m / B * (1 - q);
  const Pid pid = make_pid(gains(in), Ts);
  PidState state;
  double x = in["x0"], speed = 0;
  std::vector<double> xs, us;
  const std::vector<int> samples = in["samples"];
  for (int k = 0; k <= samples.back(); ++k) {
    const double u = step(pid, state, r, x);
    if (std::find(samples.begin(), samples.end(), k) != samples.end())
      xs.push_back(x), us.push_back(u);
    x += B > 0 ? c * speed + (Ts / B - c / B) * u : Ts * speed + Ts * Ts / (2 * m) * u;
    speed = B > 0 ? q * speed + (1 - q) / B * u : speed + Ts / m * u;
  }
  const auto n = static_cast<Eigen::Index>(xs.size());
  check.values("x", Eigen::Map<Eigen::VectorXd>(xs.data(), n), v["out"]["x"], v["tol"]);
  check.values("u", Eigen::Map<Eigen::VectorXd>(us.data(), n), v["out"]["u"], v["tol"]);
}

TEST(Pid, golden) {
  golden::run("pid",
              {{"coeffs", coefficients},
               {"sequence", [](const auto& v, auto& c) { with_history(v, c, true); }},
               {"sequence_no_kick", [](const auto& v, auto& c) { with_history(v, c, false); }},
               {"clamped", clamped},
               {"closed_loop", closed_loop}},
              {"impedance"});  // master/force_law_test
}

TEST(Pid, PublishedLiteralGainsGiveThePublishedCoefficients) {
  const IncrementalPid p = make_incremental_pid({.kp = 1.5, .ki = 0.0013, .kd = 5}, 0.01);
  EXPECT_DOUBLE_EQ(p.a, 501.5000065);
  EXPECT_DOUBLE_EQ(p.b, -1001.4999935);
  EXPECT_DOUBLE_EQ(p.c, 500);
}

TEST(Pid, DerivativeOnMeasurementIgnoresSetPointSteps) {
  const Pid pid = make_pid({.kd = 2, .derivative_on_measurement = true}, 0.001);
  PidState s;
  EXPECT_EQ(step(pid, s, 0, 0), 0);
  EXPECT_EQ(step(pid, s, 5, 0), 0);
  EXPECT_NEAR(step(pid, s, 5, 0.003), -2 * 0.003 / 0.001, 1e-12);
}

TEST(Pid, DerivativeFilterReachesThePlainDerivativeOfARamp) {
  const Pid pid = make_pid({.kd = 1, .derivative_cutoff_hz = 30}, 0.001);
  PidState s;
  double u = 0, previous = -1;
  for (int k = 0; k < 200; ++k) {
    u = step(pid, s, 0.004 * k, 0);
    EXPECT_GE(u, previous - 1e-12);
    previous = u;
  }
  EXPECT_NEAR(u, 4.0, 1e-9);
}

TEST(Pid, IntegralStopsAtTheLimitAndLeavesItAtOnce) {
  const Pid pid = make_pid({.kp = 1, .ki = 100, .limit = 2}, 0.01);
  PidState s;
  for (int k = 0; k < 1000; ++k) EXPECT_LE(step(pid, s, 1, 0), 2.0);
  EXPECT_TRUE(s.saturated);
  EXPECT_LT(step(pid, s, -1, 0), 2.0);  // no seconds of unwinding
  EXPECT_FALSE(s.saturated);
}

// Each is too small to change a plain sum at all.
TEST(Pid, IntegralOfVerySmallStepsKeepsTheirSum) {
  const Pid pid = make_pid({.ki = 1}, 0.001);
  PidState s;
  step(pid, s, 1, 0);
  s.I = 1;
  s.I_lost = 0;
  constexpr int kSteps = 1000000;
  const double small = 0x1p-53 / 1.5;
  s.e = small * 1000;
  for (int k = 0; k < kSteps; ++k) step(pid, s, small * 1000, 0);
  EXPECT_NEAR(s.I - 1, kSteps * small, 1e-15);
}

TEST(Pid, FeedforwardSharesTheLimit) {
  const Pid pid = make_pid({.kp = 1, .limit = 3}, 0.01);
  PidState s;
  EXPECT_EQ(step(pid, s, 1, 0, 1), 2);
  EXPECT_EQ(step(pid, s, 1, 0, 10), 3);
}

TEST(Pid, NonFiniteInputGivesZeroAndKeepsTheState) {
  const Pid pid = make_pid({.kp = 1, .ki = 1, .kd = 1}, 0.01);
  PidState s;
  step(pid, s, 1, 0);
  const double integral = s.I;
  EXPECT_EQ(step(pid, s, NAN, 0), 0);
  EXPECT_EQ(step(pid, s, 1, INFINITY), 0);
  EXPECT_EQ(step(pid, s, 1, 0, NAN), 0);
  EXPECT_EQ(s.I, integral);
  EXPECT_TRUE(std::isfinite(step(pid, s, 1, 0.5)));
}

}  // namespace
}  // namespace farhand
