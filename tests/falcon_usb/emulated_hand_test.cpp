// The simulated hand and handle behind the emulated USB.
#include <gtest/gtest.h>

#include "master/falcon_usb/emulator/scripted_hand.hpp"
#include "master/position_control.hpp"
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

std::vector<Press> gesture(double at) {
  return {{Button::dead_man, at, 0.8}, {Button::clutch, at, 0.8}};
}

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

// ---- F1, without weight, through the USB and without

struct Step {
  double settled_s = 0;  // within 1.5 mm from then on
  double overshoot = 0;  // [m] along the way
};

const Vec3 kFrom(0.015, -0.057, 0.118), kTo(0.025, -0.025, 0.115);

// `device` turns a torque into the position and the angles 10 ms later.
template <typename Device>
Step step_response(Device&& device) {
  PositionControl control({.gravity_mass = 0, .set_points = {{0ms, kTo}}}, 0.01);
  Step out;
  HandleReading reading{.ok = true};
  reading.theta.head<3>() = motor_angles(kFalconTable1, kFrom).theta1;
  Vec3 last = kFrom;
  for (int i = 0; i < 1000; ++i) {
    const Vec3 p = forward(kFalconTable1, reading.theta.head<3>()).p_MH;
    LimitSet limits = kLimitNone;
    const Vec3 f_H_M =
        control.step(kStart + i * 10ms, {.p_MH = p, .v_MH = (p - last) / 0.01}, limits);
    last = p;
    const Vec3 truth = device(torque_for(reading, f_H_M), reading);
    if ((truth - kTo).norm() > 0.0015) out.settled_s = (i + 1) * 0.01;
    out.overshoot = std::max(out.overshoot, (truth - kTo).dot((kTo - kFrom).normalized()));
  }
  return out;
}

SimHandConfig grip_of_f1() {
  SimHandConfig sim{.presses = gesture(0.1), .start_p_MH = kFrom, .encoder_step = 0};
  sim.device = {.mass = 0.3, .damping = 55, .friction = 0, .weight = 0};
  return sim;
}

TEST(EmulatedHand, F1IsTheSameThroughTheUsbWithin2PercentAndACount) {
  SimHand<FalconGeometry> plain(kFalconTable1, grip_of_f1());
  plain.read(kStart);
  TimePoint now = kStart;
  const Step without = step_response([&](const Vec6& tau, HandleReading& reading) {
    plain.write(now, tau);
    reading = plain.read(now += 10ms);
    return plain.truth().state.p_MH;
  });
  HandRig rig({.processor = {.firmware_loaded = true, .homed = true}}, grip_of_f1());
  rig.wait(1);
  ASSERT_EQ(rig.phase(), Phase::armed);
  const Step with = step_response([&](const Vec6& tau, HandleReading& reading) {
    rig.live(0.01, 1ms, [&](const HandleReading&) { return tau; });
    reading = rig.driver.read(rig.now);
    return rig.hand.truth().state.p_MH;
  });
  const double count = 0.06 * theta1_quantum(kFalconTable1);  // [m] at the arm's end
  EXPECT_LE(std::abs(with.settled_s - without.settled_s), 0.02 * without.settled_s + 0.01)
      << with.settled_s << " against " << without.settled_s;
  EXPECT_LE(std::abs(with.overshoot - without.overshoot), 0.02 * without.overshoot + count)
      << with.overshoot << " against " << without.overshoot;
}

}  // namespace
}  // namespace farhand::falcon_usb
