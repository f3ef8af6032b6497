#include "common/scene_outline.hpp"

#include <gtest/gtest.h>

#include "proto/scene.pb.h"

namespace farhand {
namespace {

SceneOutline of(const std::string& text) {
  return outline(text, *proto::Scene::descriptor());
}

TEST(SceneOutline, FindsValuesMessagesAndElements) {
  const auto o =
      of("rate_hz: 100\nmaster {\n  sim_hand {\n    push { at_s: 1 force_newton: [1, -2,\n 3] }\n  "
         "  push { at_s: 2 }\n  }\n}");
  EXPECT_FALSE(o.fault);
  EXPECT_EQ(find(o, "rate_hz"), (ScenePosition{1, 10}));
  EXPECT_EQ(find(o, "master"), (ScenePosition{2, 1}));
  EXPECT_EQ(find(o, "master.sim_hand.push[0].force_newton"), (ScenePosition{4, 20}));
  EXPECT_EQ(find(o, "master.sim_hand.push[0].force_newton[1]"), (ScenePosition{4, 38}));
  EXPECT_EQ(find(o, "master.sim_hand.push[0].force_newton[2]"), (ScenePosition{5, 2}));
  EXPECT_EQ(find(o, "master.sim_hand.push[1].at_s"), (ScenePosition{6, 18}));
}

TEST(SceneOutline, WhatIsMissingIsLookedForAroundIt) {
  const auto o = of("\nmaster {\n sim_hand { push {} } }");
  EXPECT_EQ(find(o, "master.sim_hand.push[0].at_s"), (ScenePosition{3, 13}));
  EXPECT_EQ(find(o, "master.force_feedback.fade_ms"), (ScenePosition{2, 1}));
  EXPECT_EQ(find(o, "slave.workspace"), (ScenePosition{1, 1}));
}

TEST(SceneOutline, ElementsOfRepeatedFieldsCountOnAcrossLists) {
  const auto o = of("slave { sim_arm { start_deg: 1 start_deg: [2, 3]\n start_deg: 4 } }");
  EXPECT_EQ(find(o, "slave.sim_arm.start_deg[2]"), (ScenePosition{1, 47}));
  EXPECT_EQ(find(o, "slave.sim_arm.start_deg[3]"), (ScenePosition{2, 13}));
}

TEST(SceneOutline, StopsAtTheFirstFault) {
  const auto o = of("master {\n falkon {} }\nrate_hz: 1");
  ASSERT_TRUE(o.fault);
  EXPECT_EQ(o.fault->field, "master.falkon");
  EXPECT_EQ(o.fault_position, (ScenePosition{2, 2}));
  EXPECT_FALSE(o.positions.contains("rate_hz"));
}

TEST(SceneOutline, NamesTheFieldBeforeAPosition) {
  const auto o = of("rate_hz: 100\nmaster { falcon { gear_ratio: 8 } }");
  EXPECT_EQ(field_at(o, {1, 1}), "scene");
  EXPECT_EQ(field_at(o, {1, 12}), "rate_hz");
  EXPECT_EQ(field_at(o, {2, 35}), "master.falcon.gear_ratio");
}

}  // namespace
}  // namespace farhand
