#include "common/energy_budget.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <limits>

#include "common/echo_delay.hpp"
#include "common/random.hpp"

namespace farhand {
namespace {

TEST(EnergyBudget, KeepsInflowAndOutflowApart) {
  EnergyBudget b(0.02);  // and a pool of half that
  b.charge(0.51), b.charge(-0.11), b.charge(0.26);
  EXPECT_NEAR(b.in(), 0.75, 1e-15);
  EXPECT_NEAR(b.out(), 0.1, 1e-15);
  EXPECT_NEAR(b.left(), 0.02 - 0.1 + 0.01, 1e-15);  // what was told may not come out here
}

// A hand that holds, and encoder noise under force.
TEST(EnergyBudget, ToAndFroCostsNeitherSideAnything) {
  EnergyBudget b(0.02);
  b.charge(0.01);
  for (int i = 0; i < 100000; ++i) b.charge(i % 2 == 0 ? -0.009 : 0.009);
  EXPECT_EQ(b.in(), 0);
  EXPECT_EQ(b.out(), 0);
  EXPECT_NEAR(b.left(), 0.03, 1e-9);
}

// A robot that lags: what the hand gives and does not get back gathers at the peer.
TEST(EnergyBudget, ReturnsASurplusWhereAskedTo) {
  EnergyBudget keeps(0.02), returns(0.02, true);
  for (EnergyBudget* b : {&keeps, &returns}) b->receive(1), b->charge(-0.1);
  EXPECT_NEAR(keeps.left(), 0.92, 1e-12);
  EXPECT_EQ(keeps.in(), 0);
  EXPECT_NEAR(returns.left(), 0.04, 1e-12);
  EXPECT_NEAR(returns.in(), 0.9 * 0.88, 1e-12);
}

// As around the operator's port alone, where the budget receives its own inflow.
TEST(EnergyBudget, HoursOfDragAreNotKept) {
  EnergyBudget b(0.02);
  for (int i = 0; i < 10000; ++i) b.charge(0.001), b.receive(b.in()), b.cap(0.2);
  EXPECT_NEAR(b.left(), 0.2, 1e-12);
}

// Whatever is charged, what came out in all is what went in, less what the peer was told and what
// the pool holds, plus what `out` counts.
TEST(EnergyBudget, LosesAndMakesNoEnergy) {
  Random random(1);
  EnergyBudget b(0.02);
  double balance = 0;
  for (int i = 0; i < 100000; ++i) {
    const double work = 0.02 * (2 * random.uniform() - 1);
    b.charge(work);
    balance += work;
    const double pool = b.left() - 0.02 + b.out();
    ASSERT_GE(pool, -1e-9);
    ASSERT_LE(pool, 0.01 + 1e-9);
    ASSERT_NEAR(b.in() - b.out() + pool, balance, 1e-9);
  }
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
