#include "common/energy_budget.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <limits>

#include "common/echo_delay.hpp"

namespace farhand {
namespace {

TEST(EnergyBudget, KeepsInflowAndOutflowApart) {
  EnergyBudget b(0.02);
  b.charge(0.5), b.charge(-0.1), b.charge(0.25);
  EXPECT_EQ(b.in(), 0.75);
  EXPECT_EQ(b.out(), 0.1);
  EXPECT_NEAR(b.left(), 0.02 - 0.1, 1e-15);  // what went in here may not come out here
}

TEST(EnergyBudget, TakesTheMostItHeardWhateverTheOrder) {
  EnergyBudget b(0.02), twice(0.02);
  for (const double in : {0.1, 0.4, 0.2, 0.4, 0.3})
    b.receive(in), twice.receive(in), twice.receive(in);
  EXPECT_NEAR(b.left(), 0.42, 1e-15);
  EXPECT_EQ(b.left(), twice.left());
  b.receive(std::numeric_limits<double>::quiet_NaN());
  EXPECT_EQ(b.left(), twice.left());
}

TEST(EnergyBudget, ANewPeerBringsNoMoreThanTheStoreAlong) {
  EnergyBudget b(0.02);
  b.receive(3), b.charge(-1);
  b.restart();
  EXPECT_NEAR(b.left(), 0.02, 1e-15);
  b.receive(0.1), b.charge(-0.11);
  EXPECT_NEAR(b.left(), 0.01, 1e-15);
  b.charge(-0.05);
  b.restart();
  EXPECT_NEAR(b.left(), -0.04, 1e-15);  // a debt stays
}

TEST(EchoDelay, UpAtOnceDownSlowlyNeverBelowThePresentAge) {
  EchoDelay d({.Ts = 0.001, .margin = 0.002, .decay = 2, .most = 0.4});
  EXPECT_NEAR(d.step(std::chrono::milliseconds(50)), 0.052, 1e-12);
  EXPECT_NEAR(d.step(std::chrono::milliseconds(90)), 0.092, 1e-12);
  for (int i = 0; i < 2000; ++i) d.step(std::chrono::milliseconds(50));
  EXPECT_NEAR(d.delay(), 0.052 + 0.040 * std::exp(-1), 1e-4);
  EXPECT_EQ(d.step(std::chrono::seconds(9)), 0.4);
  EXPECT_EQ(EchoDelay({}).step(std::chrono::milliseconds(-1)), 0.002);
}

TEST(EchoDelay, TheCouplingEndsWhereTheRoundTripIsTooLong) {
  const EchoDelayConfig c{.most = 0.5};
  EXPECT_EQ(coupling_share(c, std::chrono::milliseconds(600)), 1);
  EXPECT_NEAR(coupling_share(c, std::chrono::milliseconds(700)), 0.5, 1e-12);
  EXPECT_EQ(coupling_share(c, std::chrono::milliseconds(800)), 0);
  EXPECT_EQ(coupling_share(c, std::chrono::seconds(30)), 0);
}

}  // namespace
}  // namespace farhand
