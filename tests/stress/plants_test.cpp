// Both simulated plants with stiffness, mass and step over six decades: what the scene's rules let
// pass stays finite and gains no energy beyond what was put in; all else is refused at start in a
// sentence that says which number to change.
#include <gtest/gtest.h>
#include <spdlog/fmt/fmt.h>

#include <cmath>
#include <cstdio>

#include "common/scene.hpp"
#include "master/build.hpp"
#include "master/devices.hpp"
#include "slave/build.hpp"
#include "slave/robots.hpp"

namespace farhand {
namespace {

constexpr Duration kTick = std::chrono::milliseconds(1);

// Nothing where the scene is refused, and then the sentence in `why`.
std::optional<Scene> accepted(const std::string& text, std::string& why) {
  try {
    return parse_scene(text, "stress.textproto");
  } catch (const std::runtime_error& e) {
    why = e.what();
    return {};
  }
}

std::string arm_scene(double stiffness, double damping, double rate) {
  return fmt::format(
      "master {{ twin_delta {{}} sim_hand {{}} }} slave {{ workspace {{}} joint_pid {{}} sim_arm "
      "{{ "
      "rate_hz: {} friction: false encoder_step_rad: 0 "
      "surface {{ plane {{ point_m: [0, 0, 0.34] normal: [0, 0, 1] }} "
      "stiffness_newton_per_m: {} damping_newton_s_per_m: {} }} }} }}",
      rate, stiffness, damping);
}

// The drives are off: the arm falls on the plane 49 mm below its tool, bounces and comes to lie.
// What it has beyond its start, the spring of the plane included, is what integration made up.
TEST(StressedArm, FallsOnSurfacesOfSixDecades) {
  constexpr double kMade = 0.002;  // measured: 0.1 %
  int ran = 0, refused = 0;
  double worst = 0;
  for (const double rate : {1000.0, 3000.0, 10000.0})
    for (const double stiffness : {1e1, 1e2, 1e3, 1e4, 1e5, 1e6, 1e7})
      for (const double damping : {0.0, 1e-3 * stiffness}) {
        const std::string what =
            fmt::format("{:g} N/m, {:g} N s/m, {:g} Hz", stiffness, damping, rate);
        std::string why;
        const auto scene = accepted(arm_scene(stiffness, damping, rate), why);
        if (!scene) {
          ++refused;
          EXPECT_NE(why.find("too hard for the arm's integration steps"), std::string::npos) << why;
          EXPECT_NE(why.find("raise sim_arm.rate_hz"), std::string::npos) << why;
          continue;
        }
        ++ran;
        SimArm arm = std::get<SimArm>(make_robot(scene->proto, 1));
        const double start = arm.truth().energy;
        const ArmDynamics dynamics = make_arm_dynamics(arm.config().model);
        double made = 0, deepest = 0, lowest = start;
        TimePoint now{};
        for (int k = 0; k < 2000; ++k, now += kTick) {
          ASSERT_TRUE(arm.read(now).ok) << what << ", tick " << k;
          arm.write(now, Vec6::Zero());
          const SimArmTruth t = arm.truth();
          const double depth = std::max(0.0, t.penetration);
          made = std::max(made, t.energy + 0.5 * stiffness * depth * depth - start);
          deepest = std::max(deepest, depth);
          lowest = std::min(lowest, energy(dynamics, t.q, Vec6::Zero()));
        }
        const double swing = start - lowest;
        worst = std::max(worst, made / swing);
        std::printf("arm, %s: %.1e J made of %.1f J that fell, %.3f mm deep\n", what.c_str(), made,
                    swing, deepest * 1e3);
        EXPECT_GT(deepest, 0) << what;
        EXPECT_LE(made, kMade * swing) << what;
      }
  std::printf("arm: %d ran, %d refused; at most %.2e of what fell was made\n", ran, refused, worst);
  EXPECT_GT(ran, 20);
  EXPECT_GT(refused, 5);
}

std::string hand_scene(double mass, double stiffness, double damping, double rate) {
  return fmt::format(
      "master {{ falcon {{}} sim_hand {{ device_mass_kg: {} "
      "device_damping_newton_s_per_m: 0 device_friction_newton: 0 device_weight_newton: 0 "
      "encoder_step_rad: 0 rate_hz: {} operator {{ hand_mass_kg: 0 stiffness_newton_per_m: {} "
      "damping_newton_s_per_m: {} }} push {{ at_s: 0 lasting_s: 0.1 force_newton: [{}, 0, 0] }} }} "
      "}} slave {{ sim_arm {{}} workspace {{}} joint_pid {{}} }}",
      mass, rate, stiffness, damping, 0.02 * std::min(stiffness, 50.0));
}

// Pushed once, then left to the hand's spring. From the end of the push on, spring and mass
// together gain nothing but the ripple of a symplectic step, up to w h / 2 of their energy to
// either side.
TEST(StressedHand, SwingsOnSpringsOfSixDecades) {
  int ran = 0, refused = 0;
  double worst = 0;
  for (const double rate : {1000.0, 7000.0, 50000.0})
    for (const double mass : {0.01, 0.1, 1.0, 20.0})
      for (const double stiffness : {5e-3, 5e-2, 5e-1, 5.0, 50.0, 500.0, 5000.0})
        for (const double damping : {0.0, 0.1 * std::sqrt(stiffness * mass),
                                     std::min(500.0, 100 * std::sqrt(stiffness * mass))}) {
          const std::string what =
              fmt::format("{:g} kg, {:g} N/m, {:g} N s/m, {:g} Hz", mass, stiffness, damping, rate);
          std::string why;
          const auto scene = accepted(hand_scene(mass, stiffness, damping, rate), why);
          if (!scene) {
            ++refused;
            EXPECT_NE(why.find("is too coarse for the stiffness and damping"), std::string::npos)
                << why;
            continue;
          }
          std::optional<AnyDevice> device;
          try {
            device = make_device(*scene, {}, 1);
          } catch (const std::runtime_error& e) {
            ++refused;
            EXPECT_NE(std::string(e.what()).find("steps"), std::string::npos) << e.what();
            continue;
          }
          ++ran;
          auto& hand = std::get<SimHand<FalconGeometry>>(*device);
          double first = 0, most = 0;
          TimePoint now{};
          for (int k = 0; k < 3000; ++k, now += kTick) {
            ASSERT_TRUE(hand.read(now).ok) << what << ", tick " << k;
            hand.write(now, Vec6::Zero());
            const HandTruth& t = hand.truth();
            ASSERT_TRUE(t.state.p_MH.allFinite() && t.state.v_MH.allFinite()) << what;
            const double E = 0.5 * mass * t.state.v_MH.squaredNorm() +
                             0.5 * stiffness * (t.state.p_MH - t.wish.p.x).squaredNorm();
            if (k == 110) first = E;
            if (k > 110) most = std::max(most, E);
          }
          const double wh = std::sqrt(stiffness / mass) / rate;
          const double ripple = (1 + wh / 2) / (1 - wh / 2);
          if (first > 0) worst = std::max(worst, most / first);
          EXPECT_GT(first, 0) << what;
          EXPECT_LE(most, first * ripple * (1 + 1e-9)) << what << ", w h " << wh;
        }
  std::printf("hand: %d ran, %d refused; the most energy was %.3f times the first\n", ran, refused,
              worst);
  EXPECT_GT(ran, 80);
  EXPECT_GT(refused, 2);
}

}  // namespace
}  // namespace farhand
