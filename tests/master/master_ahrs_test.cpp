// The master's tick with an AHRS on a Falcon's grip, by samples without error.
#include <gtest/gtest.h>

#include "master/master.hpp"
#include "tests/support/allocations.hpp"

namespace farhand {
namespace {

using std::chrono::milliseconds;

constexpr int kSamplePeriod = 5;   // [ms] of the AHRS
constexpr double kTurnRate = 0.5;  // [rad/s] about up, from kTurning on
constexpr int kTurning = 2000;     // [ms]

struct GrippedMaster {
  explicit GrippedMaster(bool ahrs) : master(config(ahrs)) {
    reading.theta.head<3>() = motor_angles(kFalconTable1, p_MH).theta1;
  }
  static MasterConfig config(bool ahrs) {
    MasterConfig c;
    c.handle = FalconHandle{};
    if (ahrs) c.grip_motion.emplace();
    return c;
  }
  // To the end of the millisecond before `until`.
  const MasterTick& run(int until) {
    const MasterTick* t = nullptr;
    for (; ms < until; ++ms) {
      reading.ahrs.reset();
      if (speaks && ms % kSamplePeriod == 0)
        reading.ahrs = AhrsSample{.gyro = Vec3(0, ms > kTurning ? kTurnRate : 0, 0),
                                  .acceleration = Vec3(0, kGravity, 0),
                                  .time = milliseconds(ms)};
      const Peer<SlaveToMaster> slave{
          .newest = &answer, .connected = true, .age = Duration::zero(), .synced = true};
      sent = master.sample(TimePoint(milliseconds(ms)), reading, slave);
      t = &master.actuate(TimePoint(milliseconds(ms)), slave);
    }
    return *t;
  }

  const Vec3 p_MH{0.01, 0.005, 0.12};
  Master master;
  HandleReading reading{.ok = true};
  SlaveToMaster answer{.mode = Mode::ready};
  MasterToSlave sent;
  bool speaks = true;
  int ms = 0;
};

TEST(MasterAhrs, TheHandleIsReadyAfterTheSensorsFirstSecondAndThenTurnsAsTheGrip) {
  GrippedMaster rig(true);
  EXPECT_EQ(rig.run(900).mode, Mode::aligning);
  EXPECT_EQ(rig.sent.reason, Reason::no_attitude);
  EXPECT_EQ(rig.run(1100).mode, Mode::ready);
  rig.reading.dead_man = true;
  EXPECT_EQ(rig.run(kTurning).mode, Mode::engaged);
  EXPECT_NEAR((rig.sent.q_MH.toRotationMatrix() - Mat3::Identity()).norm(), 0, 1e-6);
  const MasterTick& t = rig.run(kTurning + 1000);
  const Vec3 turned = rotation_vector(t.handle.X_MH.R);
  EXPECT_NEAR(turned.y(), kTurnRate, 0.01);
  EXPECT_NEAR((turned - turned.y() * Vec3::UnitY()).norm(), 0, 1e-3);
  EXPECT_NEAR((t.out.V_MH.angular - kTurnRate * Vec3::UnitY()).norm(), 0, 0.01);
  EXPECT_NEAR((t.handle.X_MH.p - rig.p_MH).norm(), 0, 1e-9);
  EXPECT_EQ(t.handle.R_MG, Mat3::Identity());
}

TEST(MasterAhrs, LossKeepsTheHandleEngagedAndItsOrientation) {
  GrippedMaster rig(true);
  rig.run(1100);
  rig.reading.dead_man = true;
  rig.run(3000);
  rig.speaks = false;
  const Mat3 R = rig.run(3200).handle.X_MH.R;
  const MasterTick& t = rig.run(5000);
  EXPECT_EQ(t.ahrs, AhrsState::lost);
  EXPECT_EQ(t.mode, Mode::engaged);
  EXPECT_NEAR((t.handle.X_MH.R - R).norm(), 0, 1e-12);
  EXPECT_EQ(t.out.V_MH.angular, Vec3(Vec3::Zero()));
  EXPECT_GT(t.yaw_sigma, 0.5);
}

// A device that is silent for a while: the handle holds, and is READY again by itself.
TEST(MasterAhrs, ASilentDeviceIsNoSecondStart) {
  GrippedMaster rig(true);
  rig.run(1500);
  rig.reading.ok = false;
  EXPECT_EQ(rig.run(1530).reason, Reason::silent);
  EXPECT_EQ(rig.sent.V_MH.linear, Vec3(Vec3::Zero()));
  rig.reading.ok = true;
  EXPECT_EQ(rig.run(1535).mode, Mode::ready);
}

TEST(MasterAhrs, WithoutTheStageSamplesMeanNothing) {
  GrippedMaster rig(false);
  const MasterTick& t = rig.run(3000);
  EXPECT_FALSE(t.has_ahrs);
  EXPECT_EQ(t.mode, Mode::ready);
  EXPECT_EQ(t.handle.X_MH.R, Mat3(Mat3::Identity()));
}

TEST(MasterAhrs, NothingAllocates) {
  GrippedMaster rig(true);
  EXPECT_EQ(allocations_in([&] { rig.run(3000); }), 0u);
}

}  // namespace
}  // namespace farhand
