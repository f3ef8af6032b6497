// The observer against the simulated plant it models, and the stages that live on it.
#include "master/device_observer.hpp"

#include <gtest/gtest.h>

#include "master/contact_damping.hpp"
#include "master/device_feedforward.hpp"
#include "master/disturbance_observer.hpp"
#include "master/hand_plant.hpp"

namespace farhand {
namespace {

constexpr double kTs = 0.001;

// The simulated device with known loads of hand and motors, its pose measured without error.
struct Rig {
  explicit Rig(const DeviceModel& model) : observer(model, {}, kTs) { measure(); }

  void measure() {
    pose.X_MH.p = state.p_MH;
    pose.R_MG = handle_axes(state.axis_M, pose.R_MG.col(0));
    pose.twist = state.twist;
  }
  // One period; `told` of the load is known to the observer.
  const DeviceMotion& tick(const DeviceAxes& load, const DeviceAxes& told) {
    const HandLoad motors{load.segment<3>(0).matrix(), load.segment<3>(3).matrix(), load[6]};
    for (int i = 0; i < 10; ++i) step(plant, state, {}, motors, Vec3::Zero(), kTs / 10);
    measure();
    return observer.step(pose, told);
  }

  Plant plant{.hand = kNobody};
  HandState state{.p_MH = Vec3(0.18, 0, 0)};
  HandlePose pose;
  DeviceObserver observer;
};

// Off the slip speeds of friction, to and fro on all axes.
DeviceAxes swing_load(double t) {
  DeviceAxes load;
  load << 4, 3, 5, 0.05, 0.07, 0, 0.004;
  load *= std::cos(6 * t);
  load[2] += 2;  // the weight
  return load;
}

TEST(DeviceObserver, FollowsADeviceThatIsAsItsModelOnEveryAxis) {
  Rig rig(DeviceModel{});
  for (int k = 0; k < 3000; ++k) {
    const DeviceAxes load = swing_load(kTs * k);
    const DeviceMotion& m = rig.tick(load, load);
    if (k < 500) continue;
    EXPECT_LT((m.v.segment<3>(0).matrix() - rig.state.v_MH).norm(), 2e-3) << k;
    EXPECT_LT((m.v.segment<3>(3).matrix() - rig.state.omega_M).norm(), 0.04) << k;
    EXPECT_NEAR(m.v[6], rig.state.twist_rate, 0.02) << k;
    EXPECT_LT(m.rest.segment<3>(0).matrix().norm(), 0.25) << k;
  }
}

TEST(DeviceObserver, WhatNobodyToldItIsTheUnexplainedLoad) {
  Rig rig(DeviceModel{});
  DeviceAxes weight = DeviceAxes::Zero();
  weight[2] = 2;
  DisturbanceObserver user({.share = 0, .cutoff_hz = 10}, kTs);
  DeviceAxes pushed = weight, estimate;
  pushed[0] += 3;
  for (int k = 0; k < 400; ++k) estimate = user.step(rig.tick(pushed, weight));
  EXPECT_NEAR(estimate[0], 3, 0.05);
  EXPECT_NEAR(estimate[1], 0, 1e-9);
  EXPECT_EQ(user.against()[0], 0);
}

TEST(DeviceObserver, FeedforwardGivesTheDeviceWhatItTakes) {
  const DeviceModel model;
  const DeviceFeedforward all(
      {.gravity = 1, .damping = 1, .friction = 1, .inertia = 1, .rotation_inertia = 0.5}, model);
  DeviceMotion still;
  EXPECT_LT((all.step(still).head<3>().matrix() + model.weight_M).norm(), 1e-12);
  DeviceMotion m;
  m.v[0] = 0.3, m.a[0] = 2;
  EXPECT_NEAR(all.step(m)[0], 4 * 0.3 + 0.8 + 2, 1e-9);  // B v, F_k sliding, m a
  m = {};
  m.a[6] = 10;
  EXPECT_NEAR(all.step(m)[6], 0.5 * model.twist.inertia * 10, 1e-9);
}

TEST(DeviceObserver, ContactDampingComesAndGoesSmoothly) {
  ContactDamping damping({.translation = 15, .fade_time = 0.05}, kTs);
  const DeviceAxes v = per_axis(0.1, 0, 0);
  EXPECT_EQ(damping.step({}, v)[0], 0);
  double last = 0;
  for (int k = 0; k < 120; ++k) {
    const Wrench F{Vec3(k < 60 ? 1 : 0, 0, 0), Vec3::Zero()};
    const double now = damping.step(F, v)[0];
    EXPECT_LE(std::abs(now - last), 1.5 / 50 + 1e-12);
    if (k == 55) {
      EXPECT_NEAR(now, 1.5, 1e-12);
    }
    last = now;
  }
  EXPECT_EQ(last, 0);
}

}  // namespace
}  // namespace farhand
