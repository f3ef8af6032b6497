// Whether the tool follows: shown robots that follow, and some that do not.
#include "tests/sim/tracking.hpp"

#include <gtest/gtest.h>

#include <numbers>

#include "tests/support/scene_edits.hpp"

namespace farhand {
namespace {

class TrackingTest : public ::testing::Test {
 protected:
  // The first violation. What the slave reads and says may be spoilt.
  std::string verdict(const Scene& scene) {
    Loopback loop(scene, {.duration_s = 6});
    Checkers checkers(loop);
    Tracking tracking(loop, checkers, {}, {});
    loop.on_robot = robot;
    loop.on_reading = [&](HandleReading& r) {
      reading(r, seconds(loop.now() - loop.start()));
      tracking.sampling();
    };
    loop.on_slave = [&](SlaveTick t) {
      tick(t);
      tracking.check(t, seconds(loop.now() - loop.start()) > from);
    };
    loop.run();
    EXPECT_EQ(tracking.tool().count > 0, judged);
    return checkers.count() == 0 ? "" : checkers.first().front().what.substr(0, 18);
  }

  std::function<void(RobotReading&)> robot = [](RobotReading&) {};
  std::function<void(HandleReading&, double)> reading = [](HandleReading&, double) {};
  std::function<void(SlaveTick&)> tick = [](SlaveTick&) {};
  bool judged = true;
  double from = 0;  // [s]
};

TEST_F(TrackingTest, AcceptsARobotThatFollows) {
  EXPECT_EQ(verdict(shipped("twin_delta_free")), "");
}

TEST_F(TrackingTest, RefusesARobotThatIsElsewhere) {
  robot = [](RobotReading& r) { r.q[0] += 0.01; };
  EXPECT_EQ(verdict(shipped("twin_delta_free")), "the tool is off wh");
}

TEST_F(TrackingTest, RefusesACommandThatIsNotWhatWasAskedFor) {
  tick = [](SlaveTick& t) { t.q_cmd[1] += 1e-6; };
  EXPECT_EQ(verdict(shipped("twin_delta_free")), "the command is off");
}

// Farther and farther from where the handle is, so that no reference makes up for it.
TEST_F(TrackingTest, RefusesARobotThatFollowsAnotherHandle) {
  reading = [](HandleReading& r, double t) { r.theta[0] += 0.02 * t; };
  EXPECT_EQ(verdict(shipped("twin_delta_free")), "the tool lags more");
}

TEST_F(TrackingTest, RefusesALimitThatIsNone) {
  tick = [](SlaveTick& t) { t.limits |= kLimitSpeed; };
  judged = false;
  EXPECT_EQ(verdict(shipped("twin_delta_free")), "a limit is reporte");
}

// A tool that may never go as fast as the hand.
TEST_F(TrackingTest, JudgesNothingWhereALimitHoldsTheRobotBack) {
  Scene scene = shipped("twin_delta_free");
  scene.proto.mutable_slave()->mutable_workspace()->set_max_tool_speed_m_per_s(0.001);
  robot = [](RobotReading& r) { r.q[0] += 0.01; };
  judged = false;
  from = 1.5;  // the hand moves
  EXPECT_EQ(verdict(scene), "");
}

// Against the error transfer function of the servo, whose feed-forward is not filtered there.
TEST(IdealServo, LagsAsTheServosTransferFunctionSays) {
  const JointServoConfig config;
  constexpr double Ts = 1e-3;
  for (const double hz : {0.5, 1., 2.}) {
    const double w = 2 * std::numbers::pi * hz;
    IdealServo servo(config, Ts);
    servo.start(Vec3::Zero());
    double peak = 0;
    for (int k = 0; k < 20000; ++k) {
      const Vec3 r(0.01 * std::sin(w * Ts * k), 0, 0);
      const double error = (r - servo.step(r)).norm();
      if (k > 10000) peak = std::max(peak, error);
    }
    const double expected = std::abs(servo_error(config, w));
    EXPECT_NEAR(peak / 0.01, expected, 0.006 * expected) << hz;
  }
}

}  // namespace
}  // namespace farhand
