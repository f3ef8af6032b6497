// Where the loop stops being stable: the analysis against arithmetic done by hand and against the
// product's own loop.
#include <gtest/gtest.h>

#include <cmath>

#include "tests/loop/stability/felt.hpp"
#include "tests/loop/stability/grid.hpp"
#include "tests/loop/stability/simulated.hpp"
#include "tests/loop/stability/study.hpp"
#include "tests/support/scene_edits.hpp"

namespace farhand {
namespace {

Scene contact() {
  return shipped("twin_delta_contact");
}

Scene closed() {
  return shipped("twin_delta_closed");
}

Scene falcon() {
  return shipped("falcon_closed");
}

proto::ForceFeedback& feedback(Scene& scene) {
  return *scene.proto.mutable_master()->mutable_force_feedback();
}

Scene wall_of(double stiffness) {
  return with(contact(), 0, Parameter::wall_stiffness, stiffness);
}

TEST(Stability, ThePolesOfAnUncoupledHandAreThoseOfItsSpring) {
  AxisModel m = axis_model(contact(), 0);
  m.reflects = false;
  m.hand.device.damping = 0;
  m.hand.hand = {.mass = 0.4, .stiffness = 500, .damping = 0};
  m.hand.rate_hz = 50000;
  const double w = std::sqrt(500 / 1.4);
  bool found = false;
  for (const Pole& p : poles(loop_matrices(AxisPeriod(m)).closed(), m.Ts))
    found = found || std::abs(p.z - std::exp(std::complex<double>(0, w * m.Ts))) < 1e-6;
  EXPECT_TRUE(found);
}

TEST(Stability, TheAnswerIsAsOldAsTheNetworkAndTheCutOffMakeIt) {
  AxisModel m = axis_model(contact(), 0);
  const auto lag = [&](double round_trip) {
    m.to_slave = from_seconds(round_trip / 4);
    m.to_master = from_seconds(round_trip) - m.to_slave;
    return AxisPeriod(m).lag();
  };
  EXPECT_EQ(lag(100e-6), 0);
  EXPECT_EQ(lag(400e-6), 0);  // cut_off_us
  EXPECT_EQ(lag(401e-6), 1);
  EXPECT_EQ(lag(1400e-6), 1);
  EXPECT_EQ(lag(1401e-6), 2);
  EXPECT_EQ(lag(40e-3), 40);
}

TEST(Stability, TheGainMarginIsWhereTheWholeCommandBecomesUnstable) {
  std::vector<AxisModel> models{axis_model(closed(), 0)};
  for (const double kp : {0.0, 1.2, 8.0})
    models.push_back(axis_model(with(contact(), 0, Parameter::loop_gain, kp), 0));
  for (const AxisModel& m : models) {
    const LoopMatrices loop = loop_matrices(AxisPeriod(m));
    const double margin = margins(loop, m.Ts).gain;
    ASSERT_TRUE(std::isfinite(margin));
    EXPECT_LT(spectral_radius(loop.A + 0.99 * margin * loop.b * loop.c), 1) << margin;
    EXPECT_GT(spectral_radius(loop.A + 1.01 * margin * loop.b * loop.c), 1) << margin;
  }
}

TEST(Stability, TheSmallGainBoundIsThatOfThePublishedGains) {
  const AxisModel m = axis_model(with(contact(), 0, Parameter::loop_gain, 1.2), 0);
  EXPECT_NEAR(small_gain(m), (1.2 + 2 * 0.0011 / 0.001) * 0.4 / 1.4, 1e-12);
}

TEST(Stability, TheGainMarginIsHowMuchMoreReflectionIsStable) {
  const Scene scene = wall_of(800);
  const AxisStudy s = study_axis(scene, 0);
  ASSERT_TRUE(s.stable());
  ASSERT_EQ(s.limits[1].parameter, Parameter::reflection_gain);
  EXPECT_NEAR(s.limits[1].predicted.value / s.margins.gain, 1, 0.01);
}

TEST(Stability, TheDelayMarginIsHowMuchLongerARoundTripIsStable) {
  const AxisStudy s = study_axis(wall_of(800), 0);
  ASSERT_TRUE(s.stable());
  ASSERT_EQ(s.limits[2].parameter, Parameter::round_trip);
  EXPECT_NEAR(s.limits[2].predicted.value, s.limits[2].value + s.margins.delay, s.model.Ts);
}

TEST(Stability, BeyondItsBoundaryTheProductsLoopGrowsAsFastAsItsLargestPole) {
  for (const Scene& scene : {contact(), closed(), falcon()}) {
    const StabilityLimit limit = predicted_limit(scene, 0, Parameter::wall_stiffness);
    // Slow growth, so that the envelope is long against the oscillation.
    for (const double beyond : {1.05, 1.1}) {
      const Scene stiff = with(scene, 0, Parameter::wall_stiffness, beyond * limit.value);
      const AxisModel m = axis_model(stiff, 0);
      const double predicted = std::log(radius(m)) / m.Ts;
      EXPECT_NEAR(growth_rate(linear_scene(stiff, 0)), predicted, 0.05 * predicted)
          << scene.path << ' ' << beyond;
    }
  }
}

TEST(Stability, PredictedAndSimulatedBoundariesAgreeWithinATenth) {
  const std::vector<GridPoint> points = grid_points(true);
  std::size_t compared = 0;
  for (const GridPoint& point : points) {
    const GridPoint p = compare(contact(), 0, point);
    if (p.predicted == 0) continue;
    ++compared;
    EXPECT_NEAR(p.difference(), 0, 0.1) << to_text(std::vector{p});
  }
  EXPECT_GE(compared, points.size() / 2);
}

// The shipped scene's stages, one more of them, and a model that is wrong.
std::vector<Scene> hiding_scenes() {
  std::vector<Scene> out(4, closed());
  feedback(out[1]).mutable_disturbance_observer();
  feedback(out[2]).mutable_device_model()->set_motor_delay_ms(2);
  feedback(out[2]).mutable_device_model()->set_mass_kg(0.8);
  feedback(out[2]).mutable_device_model()->set_damping_newton_s_per_m(5);
  out[3] = falcon();
  return out;
}

TEST(Stability, BoundariesWithTheStagesThatHideTheDeviceAgreeToo) {
  const std::vector<Scene> scenes = hiding_scenes();
  const auto expect_agreement = [](const Scene& scene, Parameter p) {
    const StabilityLimit limit = predicted_limit(scene, 0, p);
    ASSERT_TRUE(limit.value > 0 && std::isfinite(limit.value)) << text(p).name;
    EXPECT_NEAR(simulated_limit(scene, 0, p, limit.value) / limit.value, 1, 0.01) << text(p).name;
  };
  for (std::size_t i = 0; i < scenes.size(); ++i) {
    SCOPED_TRACE(i);
    const double wall = predicted_limit(scenes[i], 0, Parameter::wall_stiffness).value;
    const Scene near = with(scenes[i], 0, Parameter::wall_stiffness, 0.9 * wall);
    for (const Parameter p :
         {Parameter::wall_stiffness, Parameter::reflection_gain, Parameter::round_trip})
      expect_agreement(near, p);
    expect_agreement(with(near, 0, Parameter::round_trip, 8e-3), Parameter::wall_stiffness);
  }
  expect_agreement(scenes.back(), Parameter::loop_gain);
}

TEST(Stability, EachStageThatKnowsTheDeviceMovesTheBoundary) {
  const auto limit = [](const Scene& scene) {
    return predicted_limit(scene, 0, Parameter::wall_stiffness).value;
  };
  const double all = limit(closed());
  Scene without = closed();
  feedback(without).clear_contact_damping();
  EXPECT_LT(limit(without), 0.9 * all);
  without = closed();
  feedback(without).clear_device_feedforward();
  EXPECT_GT(limit(without), 1.1 * all);
}

TEST(Stability, WithFrictionAndOnesidedWallOnlyWhatLiesBeyondTheBoundaryChatters) {
  EXPECT_FALSE(chatters(pressing_scene(closed(), 0)));
  EXPECT_TRUE(chatters(pressing_scene(with(closed(), 0, Parameter::wall_stiffness, 4000), 0)));
}

TEST(Stability, AKnockDiesAwayWhereTheForceMayChangeFastEnough) {
  Scene scene = closed();
  feedback(scene).set_max_force_rate_newton_per_s(2000);
  EXPECT_FALSE(chatters(pressing_scene(scene, 0, kKnock)));
  feedback(scene).set_max_force_rate_newton_per_s(200);
  EXPECT_TRUE(chatters(pressing_scene(scene, 0, kKnock)));
}

TEST(Stability, AWallIsFeltInSeriesWithTheServo) {
  for (const double wall : {200.0, 500.0, 1000.0}) {
    const Scene scene = with(wall_of(wall), 0, Parameter::round_trip, 0);
    const FeltStiffness felt = felt_stiffness(axis_model(scene, 0));
    EXPECT_LT(felt.felt, wall);
    EXPECT_NEAR(measured_felt_stiffness(scene, 0) / felt.felt, 1, 0.02) << wall;
  }
}

TEST(Stability, OnlyASceneBeyondItsBoundaryIsWarnedOf) {
  EXPECT_TRUE(stability_warnings(contact()).empty());
  EXPECT_TRUE(stability_warnings(closed()).empty());
  EXPECT_EQ(stability_warnings(with(closed(), 0, Parameter::wall_stiffness, 3000)).size(), 1u);
  const auto warnings = stability_warnings(wall_of(20000));
  ASSERT_EQ(warnings.size(), 1u);
  for (const char* words : {"slave.sim_arm.surface[0]", "20000 N/m", "slave.workspace.force_scale"})
    EXPECT_NE(warnings[0].find(words), std::string::npos) << warnings[0];
}

TEST(Stability, TheWalkFindsTheNearestBoundaryOnBothSides) {
  const auto below_seven = [](double x) { return x < 7; };
  EXPECT_NEAR(nearest_limit(below_seven, 2, 0.1, 100).value, 7, 1e-3);
  const StabilityLimit down = nearest_limit(below_seven, 50, 0.1, 100);
  EXPECT_TRUE(down.beyond);
  EXPECT_NEAR(down.value, 7, 1e-3);
  EXPECT_EQ(nearest_limit([](double) { return false; }, 2, 0.1, 100).value, 0);
  EXPECT_TRUE(std::isinf(nearest_limit([](double) { return true; }, 2, 0.1, 100).value));
}

}  // namespace
}  // namespace farhand
