// The simulated hand and handle behind the emulated USB.
#include <gtest/gtest.h>

#include "master/falcon_usb/emulator/scripted_hand.hpp"
#include "tests/falcon_usb/rig.hpp"

namespace farhand::falcon_usb {
namespace {

// Driver, device and plant; a loop that turns a reading into a torque every `period`.
struct HandRig {
  HandRig(const EmulatorConfig& config, SimHandConfig sim, const DriverConfig& driver_config = {})
      : hand({}, std::move(sim)), emulator(config, hand.mechanism()), driver(driver_config) {
    emulator.plug(now);
  }
  template <typename Control>
  void live(double span_s, Duration period, Control&& control) {
    for (const TimePoint end = now + from_seconds(span_s); now < end;) {
      driver.write(now, control(driver.read(now)));
      run(emulator, driver, now, now + period);
    }
  }
  void wait(double span_s) {
    live(span_s, 1ms, [](const HandleReading&) { return Vec6(Vec6::Zero()); });
  }
  Phase phase() const { return driver.status().phase; }

  EmulatedHand hand;
  TimePoint now = kStart;
  Emulator emulator;
  Driver driver;
};

Vec6 torque_for(const HandleReading& reading, const Vec3& f_H_M) {
  Vec6 tau = Vec6::Zero();
  const FalconForward at = forward(kFalconTable1, reading.theta.head<3>());
  tau.head<3>() = torque(jacobian(kFalconTable1, at), f_H_M);
  return tau;
}

TEST(EmulatedHand, HomesByMovingTheGripAndIsArmedByTheButtons) {
  HandRig rig({.processor = {.firmware_loaded = true}}, hand_script(HandMotion::still));
  rig.wait(0.4);
  EXPECT_EQ(rig.phase(), Phase::homing);
  rig.wait(3);
  EXPECT_EQ(rig.phase(), Phase::homed);
  rig.wait(1);
  EXPECT_EQ(rig.phase(), Phase::armed);
  // What the driver reads is where the handle is, to half a count of each motor.
  const Vec3 theta = rig.driver.read(rig.now).theta.head<3>();
  EXPECT_LE((theta - rig.hand.truth().theta.head<3>()).cwiseAbs().maxCoeff(),
            0.5 * theta1_quantum(kFalconTable1) + 1e-4);
}

// Against the hand's spring of 500 N/m, in the direction and size asked for.
TEST(EmulatedHand, AForceCommandedIsTheForceThatPushesTheHand) {
  for (const Vec3& f_H_M : {Vec3(4, 0, 0), Vec3(0, 4, 0), Vec3(0, 0, -4), Vec3(2, -3, 3)}) {
    HandRig rig({.processor = {.firmware_loaded = true}}, hand_script(HandMotion::still));
    rig.wait(4.4);
    rig.live(4, 1ms, [&](const HandleReading& r) { return torque_for(r, f_H_M); });
    ASSERT_EQ(rig.phase(), Phase::armed);
    const Vec3 moved = rig.hand.truth().state.p_MH - Vec3(0, 0, 0.120);
    // Half a count of each motor is up to 2.2 mN here, of each encoder 2 mN through the map.
    EXPECT_LE((500 * moved - f_H_M).norm(), 0.005) << f_H_M.transpose();
  }
}

// A hand that is told what to do, asked once a millisecond.
struct Told {
  void wait(double span_s) {
    for (int i = 0; i < span_s * 1000; ++i) {
      now += 1ms;
      device.drive(now, {});
      grip = device.read(now);
      arrivals += hand.arrived();
    }
  }
  Vec3 place() const {
    const Eigen::Vector3i counts(grip.counts[0], grip.counts[1], grip.counts[2]);
    return forward(kFalconTable1, theta1_from_counts(kFalconTable1, counts)).p_MH;
  }
  ScriptedHand hand{HandMotion::none};
  Mechanism device = hand.mechanism();
  TimePoint now = kStart;
  GripState grip;
  int arrivals = 0;
};

TEST(EmulatedHand, BringsTheGripWhereItIsToldAndSaysSoOnce) {
  Told told;
  told.wait(0.1);
  told.hand.tell("move 20 -10 110");
  told.wait(3);
  EXPECT_LT((told.place() - Vec3(0.02, -0.01, 0.110)).norm(), 0.0005);
  EXPECT_EQ(told.arrivals, 1);
  told.hand.tell("home");
  told.wait(5);
  EXPECT_LT((told.place() - Vec3(0, 0, 0.120)).norm(), 0.0005);
  EXPECT_EQ(told.arrivals, 2);
}

TEST(EmulatedHand, PressesWhatItIsToldUntilItIsToldToRelease) {
  Told told;
  told.hand.tell("press centre plus");
  told.hand.tell("press minus");
  told.wait(1);
  EXPECT_EQ(told.grip.buttons, kButtonCentre | kButtonPlus | kButtonMinus);
  told.hand.tell("release");
  told.wait(0.01);
  EXPECT_EQ(told.grip.buttons, 0);
}

TEST(EmulatedHand, LetGoTheGripSinks) {
  Told told;
  told.wait(0.1);
  told.hand.tell("let go");
  told.wait(0.3);
  EXPECT_LT(told.place().y(), -0.01);
}

TEST(EmulatedHand, WhatItDoesNotUnderstandChangesNothing) {
  Told told;
  told.wait(0.1);
  for (const char* line :
       {"jump", "move 1 2", "move 1 2 x", "press", "press up", "weight", "let it"})
    EXPECT_THROW(told.hand.tell(line), std::runtime_error) << line;
  told.wait(1);
  EXPECT_LT((told.place() - Vec3(0, 0, 0.120)).norm(), 0.0005);
  EXPECT_EQ(told.grip.buttons, 0);
}

// Asked every 10 ms it needs ten times as long.
TEST(EmulatedHand, WhoAsksSlowlySeesItInSlowMotion) {
  Told told;
  told.wait(0.1);
  told.hand.tell("move 0 0 140");
  for (int i = 0; i < 100; ++i) {
    told.now += 9ms;
    told.wait(0.001);
  }
  EXPECT_EQ(told.arrivals, 0);
  told.wait(1);
  EXPECT_EQ(told.arrivals, 1);
}

}  // namespace
}  // namespace farhand::falcon_usb
