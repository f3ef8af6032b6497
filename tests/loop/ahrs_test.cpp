// The whole scene of a Falcon with an AHRS on its grip.
#include <gtest/gtest.h>

#include <numbers>

#include "common/statistics.hpp"
#include "tests/loop/checkers.hpp"
#include "tests/support/scene_edits.hpp"

namespace farhand {
namespace {

constexpr double kDegrees = 180 / std::numbers::pi;
const double kReturnRate = GripMotionConfig{}.return_rate;  // [rad/s]

// How far from the second to the first [rad].
double angle(const Mat3& a, const Mat3& b) {
  return rotation_vector(a * b.transpose()).norm();
}

Mat3 true_grip(const Loopback& loop) {
  return std::get<SimHand<FalconGeometry>>(loop.device()).truth().grip.R_MH;
}

// Where the grip's true orientation asks the tool to be, by the reference that the slave took.
Mat3 wanted_orientation(const Loopback& loop) {
  return loop.slave()->config().workspace.R_SM * true_grip(loop) * loop.slave()->workspace().R_HE;
}

struct ToolErrors {
  Rms command, tool, servo;  // [rad]
  double turned = 0;         // [rad] the grip at most
};

ToolErrors tool_errors(std::uint64_t seed, double rate_hz = 200) {
  Scene scene = shipped("falcon_ahrs");
  scene.proto.mutable_master()->mutable_ahrs()->set_rate_hz(rate_hz);
  Loopback loop(scene, {.seed = seed});
  Checkers checkers(loop);
  ToolErrors out;
  loop.on_master = [&](const MasterTick& t) { checkers.check(t); };
  loop.on_slave = [&](const SlaveTick& t) {
    checkers.check(t);
    if (!t.coupled) return;
    const Mat3 wanted = wanted_orientation(loop),
               tool = std::get<SimArm>(*loop.robot()).truth().X_SE.R;
    out.command.add(angle(t.X_SE_target.R, wanted));
    out.tool.add(angle(tool, wanted));
    out.servo.add(angle(tool, t.X_SE_target.R));
    out.turned = std::max(out.turned, angle(true_grip(loop), Mat3::Identity()));
  };
  loop.run();
  EXPECT_EQ(checkers.count(), 0u) << "seed " << seed;
  return out;
}

TEST(AhrsScene, TheToolTurnsAsTheGripWithinADegreeBeyondItsServo) {
  for (std::uint64_t seed = 1; seed <= 4; ++seed) {
    const ToolErrors e = tool_errors(seed);
    std::printf(
        "falcon_ahrs, seed %d: grip turns by %.0f deg; off it rms: command %.2f deg, tool %.2f deg "
        "(servo's lag %.2f deg)\n",
        static_cast<int>(seed), e.turned * kDegrees, e.command.value() * kDegrees,
        e.tool.value() * kDegrees, e.servo.value() * kDegrees);
    EXPECT_GT(e.command.count, 10000u);
    EXPECT_GT(e.turned * kDegrees, 15);
    EXPECT_LE(e.command.value() * kDegrees, 1);
    EXPECT_LE(e.tool.value(), e.servo.value() + 1 / kDegrees);
  }
}

TEST(AhrsScene, TheSlowestAndTheFastestSensorThatAreMeantDoAsWell) {
  for (const double rate : {50.0, 400.0}) {
    const ToolErrors e = tool_errors(5, rate);
    std::printf("falcon_ahrs at %.0f Hz: command %.2f deg off the grip, rms\n", rate,
                e.command.value() * kDegrees);
    EXPECT_LE(e.command.value() * kDegrees, 1) << rate;
  }
}

TEST(AhrsScene, TheHandleIsReadyOnceItsOrientationIsKnown) {
  Loopback loop(shipped("falcon_ahrs"), {.duration_s = 4});
  bool waited = false, ready = false;
  loop.on_master = [&](const MasterTick& t) {
    const bool known = t.ahrs == AhrsState::ok;
    waited |= t.mode == Mode::aligning && t.reason == Reason::no_attitude;
    ready |= t.mode == Mode::ready;
    EXPECT_TRUE(known || (t.mode != Mode::ready && t.mode != Mode::engaged));
    EXPECT_TRUE(known || t.handle.X_MH.R == Mat3::Identity());
  };
  loop.run();
  EXPECT_TRUE(waited && ready);
}

TEST(AhrsScene, WithoutASampleTheHandleIsNeverReadyAndSaysWhy) {
  Loopback loop(shipped("falcon_ahrs"), {.duration_s = 4});
  MasterTick last;
  loop.on_reading = [](HandleReading& r) { r.ahrs.reset(); };
  loop.on_master = [&](const MasterTick& t) {
    EXPECT_TRUE(t.mode != Mode::ready && t.mode != Mode::engaged);
    last = t;
  };
  loop.run();
  EXPECT_EQ(last.mode, Mode::aligning);
  EXPECT_EQ(last.reason, Reason::no_attitude);
  EXPECT_EQ(last.ahrs, AhrsState::absent);
}

// A cable that comes off for two seconds while the robot follows.
TEST(AhrsScene, LossHoldsTheOrientationTranslationGoesOnAndReturnIsSlow) {
  Loopback loop(shipped("falcon_ahrs"), {.duration_s = 14});
  const auto t = [&] { return seconds(loop.now() - loop.start()); };
  Checkers checkers(loop);
  MasterTick before;
  Pose held_MH, target_before, held_SE;
  double beyond = 0, drift = 0, way = 0, rate = 0, step = 0, off_in = 0, off_after = 0;
  bool lost = false, came_back = false;
  loop.on_reading = [&](HandleReading& r) {
    if (t() > 7 && t() < 9) r.ahrs.reset();
  };
  loop.on_master = [&](const MasterTick& tick) {
    checkers.check(tick);
    if (t() > 5) {
      const Vec3 turned = rotation_vector(tick.handle.X_MH.R * before.handle.X_MH.R.transpose());
      beyond = std::max(beyond, (turned - 0.001 * tick.out.V_MH.angular).norm());
      rate = std::max(rate, tick.out.V_MH.angular.norm());
      EXPECT_EQ(tick.mode, Mode::engaged);
    }
    if (tick.ahrs == AhrsState::lost && !lost) held_MH = tick.handle.X_MH, lost = true;
    if (tick.ahrs == AhrsState::lost) {
      EXPECT_EQ(tick.out.V_MH.angular.norm(), 0);
      EXPECT_GT(tick.yaw_sigma, before.yaw_sigma);
      drift = std::max(drift, angle(tick.handle.X_MH.R, held_MH.R));
      way = std::max(way, (tick.handle.X_MH.p - held_MH.p).norm());
      off_in = std::max(off_in, angle(tick.handle.X_MH.R, true_grip(loop)));
    }
    came_back |= lost && tick.ahrs == AhrsState::ok;
    if (t() > 13) off_after = std::max(off_after, angle(tick.handle.X_MH.R, true_grip(loop)));
    before = tick;
  };
  loop.on_slave = [&](const SlaveTick& tick) {
    checkers.check(tick);
    if (t() > 5) step = std::max(step, angle(tick.X_SE_target.R, target_before.R));
    target_before = tick.X_SE_target;
  };
  loop.run();
  std::printf(
      "falcon_ahrs, no sample for 2 s: orientation off by %.1f deg meanwhile, %.2f deg 4 s later;\n"
      "beyond its rate (%.0f deg/s at most) it turns by %.4f deg a tick; the command by %.3f deg "
      "a\n"
      "tick; the handle moves on by %.0f mm\n",
      off_in * kDegrees, off_after * kDegrees, rate * kDegrees, beyond * kDegrees, step * kDegrees,
      1e3 * way);
  EXPECT_TRUE(lost && came_back);
  EXPECT_LE(drift, 1e-9);
  EXPECT_GT(way, 0.02);
  // The documented rate; the rest is rounding.
  EXPECT_LE(beyond, 0.001 * kReturnRate + 1e-9);
  // The slave may take two messages in one of its ticks.
  EXPECT_LE(step, 2 * 0.001 * (rate + kReturnRate));
  EXPECT_GT(off_in * kDegrees, 3);
  EXPECT_LE(off_after * kDegrees, 2);
  EXPECT_EQ(checkers.count(), 0u);
}

TEST(AhrsScene, ASerialLineIsRefusedUnderVirtualTime) {
  Scene scene = shipped("falcon_ahrs");
  scene.proto.mutable_master()->mutable_ahrs()->mutable_serial()->set_path("/dev/ttyUSB0");
  EXPECT_THROW(Loopback(scene, {}), std::runtime_error);
}

TEST(AhrsScene, RotationLockKeepsTheToolAndLeavesTheVelocity) {
  Scene scene = shipped("falcon_ahrs");
  scene.proto.mutable_slave()->mutable_workspace()->set_rotation_lock(true);
  Loopback loop(scene, {.duration_s = 8});
  double turned = 0, moved = 0;
  std::optional<Pose> first;
  loop.on_slave = [&](const SlaveTick& t) {
    if (!t.coupled) return;
    if (!first) first = t.X_SE_target;
    turned = std::max(turned, angle(t.X_SE_target.R, first->R));
    moved = std::max(moved, (t.X_SE_target.p - first->p).norm());
  };
  loop.run();
  EXPECT_LE(turned, 1e-9);
  EXPECT_GT(moved, 0.02);
}

}  // namespace
}  // namespace farhand
