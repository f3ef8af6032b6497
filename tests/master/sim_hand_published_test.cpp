// The simulated Falcon under the published position control, against the published figures
// (reference section 10, F1 and F2). The product's own controller runs the same scenarios as
// scenes.
#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <cstdio>

#include "common/pid.hpp"
#include "master/sim_hand.hpp"

namespace farhand {
namespace {

using namespace std::chrono_literals;

constexpr TimePoint kStart{1234567s};  // any: only differences count

struct PositionLoop {
  SimHand<FalconGeometry> device;
  double damping = 0;
  std::array<PidState, 3> states{};
  double peak_force = 0;

  // One sample of 10 ms; returns where the grip is.
  Vec3 tick(int k, const Vec3& target) {
    const Pid pid = make_pid({.kp = 150, .ki = 13, .kd = 5}, 0.01);
    const TimePoint now = kStart + k * 10ms;
    const FalconForward at = forward(FalconGeometry{}, device.read(now).theta.head<3>());
    Vec3 f;
    for (int i = 0; i < 3; ++i) f[i] = step(pid, states[i], target[i], at.p_MH[i]);
    peak_force = std::max(peak_force, f.cwiseAbs().maxCoeff());
    f.y() += 0.3 * 9.81;
    Vec6 tau = Vec6::Zero();
    tau.head<3>() = torque(jacobian(FalconGeometry{}, at), f);
    device.write(now, tau);
    return device.truth().state.p_MH;
  }
};

const Vec3 kFrom(0.015, -0.057, 0.118), kTo(0.025, -0.025, 0.115);

PositionLoop position_loop(double damping, std::vector<Push> pushes = {}) {
  return {SimHand<FalconGeometry>(
              FalconGeometry{},
              {.device = {.mass = 0.3, .damping = damping, .friction = 0, .weight = 0.3 * 9.81},
               .pushes = std::move(pushes),
               .start_p_MH = kFrom,
               .max_motor_torque = 0.9}),
          damping};
}

double worst_axis(const Vec3& p) {
  return (p - kTo).cwiseAbs().maxCoeff();
}

TEST(SimHandPublished, TheFalconReachesItsTargetInThePublishedTime) {
  for (const double damping : {55.0, 8.0}) {
    PositionLoop loop = position_loop(damping);
    double within_1mm = 0, within_1_5mm = 0, overshoot = 0, last = 0;
    for (int k = 0; k <= 3000; ++k) {
      const Vec3 p = loop.tick(k, kTo);
      last = worst_axis(p);
      if (last > 1e-3) within_1mm = 0.01 * (k + 1);
      if (last > 1.5e-3) within_1_5mm = 0.01 * (k + 1);
      overshoot = std::max(overshoot, p.y() - kTo.y());
    }
    std::printf(
        "F1, B = %g N s/m: within 1 mm from %.2f s, 1.5 mm from %.2f s, overshoot in y "
        "%.2f mm, %.3f mm at 30 s, peak force %.2f N\n",
        damping, within_1mm, within_1_5mm, 1e3 * overshoot, 1e3 * last, loop.peak_force);
    EXPECT_LE(within_1_5mm, 1.2);
    EXPECT_LT(last, 0.15e-3);
    EXPECT_EQ(loop.device.truth().stops, 0u);
    if (damping == 55.0) {
      EXPECT_NEAR(within_1mm, 1.12, 0.112);
      EXPECT_NEAR(within_1_5mm, 1.04, 0.104);
      EXPECT_NEAR(1e3 * overshoot, 0.94, 0.094);
      EXPECT_NEAR(loop.peak_force, 4.80, 0.48);
    }
  }
}

TEST(SimHandPublished, TheFalconReturnsAfterPushesFromAllSides) {
  const std::array<double, 6> times{6.5, 11, 14.9, 19, 22, 26.5};
  std::vector<Push> pushes;
  for (int i = 0; i < 6; ++i)
    pushes.push_back({.at = times[i], .force = (i % 2 == 0 ? 3 : -3) * Vec3::Unit(i / 2)});
  for (const double damping : {55.0, 8.0}) {
    PositionLoop loop = position_loop(damping, pushes);
    double peak = 0;
    std::array<double, 6> back{};
    for (int k = 0; k <= 3000; ++k) {
      const double t = 0.01 * k, away = worst_axis(loop.tick(k, kTo));
      const auto i = std::upper_bound(times.begin(), times.end(), t) - times.begin() - 1;
      if (i < 0) continue;
      peak = std::max(peak, away);
      if (away > 1.5e-3) back[i] = t + 0.01 - times[i];
    }
    const double slowest = *std::max_element(back.begin(), back.end());
    std::printf("F2, B = %g N s/m: peak %.1f mm, back within 1.5 mm after %.2f s\n", damping,
                1e3 * peak, slowest);
    EXPECT_NEAR(1e3 * peak, damping == 55.0 ? 10 : 19, damping == 55.0 ? 1 : 1.9);
    EXPECT_LE(slowest, 1.3);
    EXPECT_GT(slowest, 0.3);
  }
}

}  // namespace
}  // namespace farhand
