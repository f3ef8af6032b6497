#include "master/motion.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <numbers>

#include "tests/support/temporary_file.hpp"

namespace farhand {
namespace {

// Checks that velocities are the derivatives of positions, everywhere and without a jump.
void expect_smooth(const Motion& motion, double until) {
  const double h = 1e-6;
  MotionSample before = motion.at(0);
  for (double t = 1e-3; t < until; t += 1e-3) {
    const MotionSample a = motion.at(t - h), s = motion.at(t), b = motion.at(t + h);
    EXPECT_LT(((b.p - a.p) / (2 * h) - s.v).norm(), 1e-5) << t;
    EXPECT_LT(((b.turn - a.turn) / (2 * h) - s.turn_rate).norm(), 1e-5) << t;
    EXPECT_LT((s.v - before.v).norm(), 0.01) << t;
    EXPECT_LT((s.turn_rate - before.turn_rate).norm(), 0.05) << t;
    before = s;
  }
}

TEST(Motion, RestsWithoutParts) {
  const Motion motion;
  for (const double t : {-1.0, 0.0, 1.0, 1e6}) {
    EXPECT_EQ(motion.at(t).p, Vec3::Zero());
    EXPECT_EQ(motion.at(t).v, Vec3::Zero());
    EXPECT_EQ(motion.at(t).turn, Vec3::Zero());
  }
}

TEST(Motion, ASineFollowsItsFormulaAwayFromTheCorner) {
  const Motion motion({.sines = {{.from = 2, .frequency = 1, .offset = {0.05, 0, 0}}}});
  EXPECT_EQ(motion.at(1.9).p.x(), 0);
  for (double t = 2; t < 12; t += 0.013) {
    const double by_formula =
        0.05 * std::sin(2 * std::numbers::pi * (t - 2)) * std::min(1.0, t - 2);
    EXPECT_NEAR(motion.at(t).p.x(), by_formula, std::abs(t - 3) < 0.1 ? 1.3e-3 : 1e-12) << t;
  }
}

TEST(Motion, SinesStartSwellAndEndWithoutAJump) {
  expect_smooth(
      Motion({.sines = {{.from = 0.3, .until = 4, .frequency = 0.43, .offset = {0.03, 0.01, 0}},
                        {.from = 1, .until = 1.7, .frequency = 2.2, .offset = {0, 0, 0.002}},
                        {.frequency = 0.7, .turn = {0.2, 0.1, 0.3}}}}),
      6);
}

TEST(Motion, ASineIsOverAtItsEnd) {
  const Motion motion({.sines = {{.until = 3, .frequency = 0.9, .offset = {0.05, 0, 0}}}});
  EXPECT_NE(motion.at(2.9).p.x(), 0);
  EXPECT_EQ(motion.at(3).p.x(), 0);
  EXPECT_LT(std::abs(motion.at(3 - 1e-6).v.x()), 1e-5);
}

TEST(Motion, AReachArrivesStaysAndIsHalfWayAtHalfTime) {
  const Motion motion({.reaches = {{.at = 1, .lasting = 2, .by = {0.04, -0.02, 0}}}});
  EXPECT_EQ(motion.at(1).p, Vec3::Zero());
  EXPECT_LT((motion.at(2).p - Vec3(0.02, -0.01, 0)).norm(), 1e-15);
  EXPECT_NEAR(motion.at(2).v.x(), 0.04 * 1.875 / 2, 1e-15);
  EXPECT_EQ(motion.at(3).p, Vec3(0.04, -0.02, 0));
  EXPECT_EQ(motion.at(1000).v, Vec3::Zero());
}

TEST(Motion, OverlappingReachesAddUpInAnyOrder) {
  const std::vector<Reach> reaches{{.at = 5, .lasting = 1, .by = {0.01, 0, 0}},
                                   {.at = 1, .lasting = 10, .by = {0, 0.02, 0}},
                                   {.at = 2, .lasting = 1, .by = {0, 0, 0.01}},
                                   {.at = 20, .lasting = 1, .turn = {0, 0, 0.5}}};
  const Motion together({.reaches = reaches});
  for (double t = 0; t < 30; t += 0.1) {
    Vec3 p = Vec3::Zero(), turn = Vec3::Zero();
    for (const Reach& r : reaches) {
      const Motion alone({.reaches = {r}});
      p += alone.at(t).p;
      turn += alone.at(t).turn;
    }
    EXPECT_LT((together.at(t).p - p).norm(), 1e-16) << t;
    EXPECT_LT((together.at(t).turn - turn).norm(), 1e-16) << t;
  }
  expect_smooth(together, 25);
}

TEST(Motion, AWishBeyondTheSpeedLimitIsRefusedInASentence) {
  const Sine fast{.frequency = 2, .offset = {0.05, 0, 0}};  // 0.63 m/s
  const std::string why = refusal([&] { Motion({.sines = {fast}}); });
  EXPECT_NE(why.find("0.628"), std::string::npos) << why;
  EXPECT_NE(why.find("limit of 0.5"), std::string::npos) << why;
  EXPECT_EQ(refusal([&] { Motion({.sines = {fast}, .limits = {.speed = 0.7}}); }), "");
  EXPECT_NE(refusal([] { Motion({.reaches = {{.lasting = 0.1, .by = {0.05, 0, 0}}}}); }), "");
  EXPECT_NE(refusal([] { Motion({.sines = {{.frequency = 1, .turn = {0.4, 0, 0}}}}); }), "");
}

TEST(Motion, PartsThatDoNotOverlapInTimeDoNotAddUp) {
  const Reach first{.at = 1, .lasting = 0.2, .by = {0.04, 0, 0}};  // 0.375 m/s
  Reach second = first;
  second.at = 1.1;
  EXPECT_NE(refusal([&] { Motion({.reaches = {first, second}}); }), "");
  second.at = 1.2;
  EXPECT_EQ(refusal([&] { Motion({.reaches = {first, second}}); }), "");
}

TEST(Motion, NoAcceptedSineExceedsItsLimit) {
  for (const double f : {0.05, 0.2, 0.35, 0.5, 1.0, 3.0}) {
    for (const double length : {0.7, 1.9, 2.3, 7.0}) {
      // The largest amplitude that is not refused, by halving.
      double low = 0, high = 0.5;
      const auto sine = [&](double a) {
        return MotionConfig{.sines = {{.until = length, .frequency = f, .offset = {0, a, 0}}}};
      };
      for (int i = 0; i < 30; ++i) {
        const double middle = (low + high) / 2;
        (refusal([&] { Motion{sine(middle)}; }).empty() ? low : high) = middle;
      }
      const Motion motion(sine(low));
      for (double t = 0; t < length; t += 1e-3)
        ASSERT_LE(motion.at(t).v.norm(), 0.5) << f << " Hz for " << length << " s at " << t;
    }
  }
}

std::string slow_circle() {
  std::string csv = "t_s,x_m,y_m,z_m\n";
  for (int i = 0; i < 1000; ++i) {
    const double t = 0.01 * i;
    csv += std::to_string(t) + "," + std::to_string(0.03 * std::cos(t)) + "," +
           std::to_string(0.03 * std::sin(t)) + ",0.4\n";
  }
  return csv;
}

TEST(Motion, ATraceIsAddedToTheOthersAndSlowedToWhatTheyLeave) {
  const TemporaryFile file(slow_circle());
  const Sine sine{.frequency = 1, .offset = {0, 0, 0.01}};  // 0.063 m/s
  const MotionConfig config{
      .sines = {sine}, .trace = TraceConfig{.file = file.path()}, .limits = {.speed = 0.08}};
  const Motion both(config), alone({.sines = {sine}});
  ASSERT_TRUE(both.trace().has_value());
  EXPECT_FALSE(alone.trace().has_value());
  EXPECT_GT(both.trace()->report().slowed, 1);
  double largest = 0;
  for (double t = 0; t < both.trace()->duration(); t += 1e-3) {
    const MotionSample s = both.at(t);
    ASSERT_LE(s.v.norm(), 0.08) << t;
    ASSERT_LT((s.p - alone.at(t).p - both.trace()->at(t).p).norm(), 1e-16) << t;
    largest = std::max(largest, s.p.head<2>().norm());
  }
  EXPECT_NEAR(largest, 0.03, 0.002);
}

TEST(Motion, ATraceThatIsLeftNoSpeedOrHasNoFileIsRefused) {
  const TemporaryFile file(slow_circle());
  const MotionConfig config{.sines = {{.frequency = 1, .offset = {0, 0, 0.01}}},
                            .trace = TraceConfig{.file = file.path()},
                            .limits = {.speed = 0.065}};
  EXPECT_NE(refusal([&] { Motion{config}; }).find("leave the trace"), std::string::npos);
  EXPECT_NE(
      refusal([] { Motion({.trace = TraceConfig{.file = "/no/such.csv"}}); }).find("/no/such.csv"),
      std::string::npos);
}

}  // namespace
}  // namespace farhand
