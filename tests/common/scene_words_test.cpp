#include "common/scene_words.hpp"

#include <gtest/gtest.h>

#include <limits>

#include "proto/scene.pb.h"

namespace farhand {
namespace {

TEST(SceneWords, UnitsComeFromTheEndOfTheName) {
  EXPECT_EQ(unit_of("max_force_newton"), "N");
  EXPECT_EQ(unit_of("max_tank_joule"), "J");
  EXPECT_EQ(unit_of("kd_newton_s_per_m"), "N s/m");
  EXPECT_EQ(unit_of("ki_newton_per_m_s"), "N/(m s)");
  EXPECT_EQ(unit_of("kp_newton_per_m"), "N/m");
  EXPECT_EQ(unit_of("max_torque_rate_newton_meter_per_s"), "N m/s");
  EXPECT_EQ(unit_of("rotation_damping_newton_m_s"), "N m s");
  EXPECT_EQ(unit_of("rotation_inertia_kg_m2"), "kg m^2");
  EXPECT_EQ(unit_of("max_tool_turn_rate_deg_per_s"), "deg/s");
  EXPECT_EQ(unit_of("integral_per_s"), "1/s");
  EXPECT_EQ(unit_of("hold_ms"), "ms");
  EXPECT_EQ(unit_of("s"), "s");
  EXPECT_EQ(unit_of("normal"), "");  // ends with neither _m nor _s
  EXPECT_EQ(unit_of("gear_ratio"), "");
  EXPECT_EQ(unit_of(""), "");
}

TEST(SceneWords, NumbersReadBackExactly) {
  EXPECT_EQ(number(0.1), "0.1");
  EXPECT_EQ(number(1e-5), "1e-05");
  EXPECT_EQ(number(4000), "4000");
  EXPECT_EQ(std::stod(number(0.004774648292756860)), 0.004774648292756860);
}

TEST(SceneWords, TheNearestNameIsASlipOfThePenAway) {
  const std::vector<std::string> names = {"plane", "sphere", "box", "stiffness_newton_per_m"};
  EXPECT_EQ(nearest("plain", names), "plane");
  EXPECT_EQ(nearest("shpere", names), "sphere");
  EXPECT_EQ(nearest("BOX", names), "box");
  EXPECT_EQ(nearest("bix", names), "box");
  EXPECT_EQ(nearest("stiffness", names), "stiffness_newton_per_m");
  EXPECT_EQ(nearest("stifness_newton_per_meter", names), "stiffness_newton_per_m");
  EXPECT_EQ(nearest("cylinder", names), std::nullopt);
  EXPECT_EQ(nearest("b", names), std::nullopt);
  EXPECT_EQ(nearest("", names), std::nullopt);
  EXPECT_EQ(nearest("plane", {}), std::nullopt);
}

TEST(SceneWords, ListsReadLikeASentence) {
  EXPECT_EQ(listed({}), "");
  EXPECT_EQ(listed({"a"}), "a");
  EXPECT_EQ(listed({"a", "b"}), "a and b");
  EXPECT_EQ(listed({"a", "b", "c"}), "a, b and c");
}

TEST(SceneWords, LegalValuesComeFromTheSchema) {
  const auto field = [](const char* name) {
    return legal_value(*proto::SimArm::descriptor()->FindFieldByName(name));
  };
  EXPECT_EQ(field("rate_hz"), "from 1000 to 10000 Hz");
  EXPECT_EQ(field("friction"), "true or false");
  EXPECT_EQ(field("start_deg"), "6 numbers, each from -360 to 360 deg");
  EXPECT_EQ(field("force_sensor"), "a message in braces, force_sensor { ... }");
}

TEST(SceneWords, WhatIsQuotedIsShortAndPrintable) {
  EXPECT_EQ(shortened("a\nb\x01\xc3\xa9"), "a?b???");
  EXPECT_EQ(shortened(std::string(100, 'x')), std::string(40, 'x') + "...");
}

}  // namespace
}  // namespace farhand
