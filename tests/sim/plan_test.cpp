// What is drawn: scenes that the programs would take, and each thing at some seed.
#include "tests/sim/plan.hpp"

#include <gtest/gtest.h>

#include <map>

#include "common/scene_check.hpp"
#include "tests/sim/plan_scene.hpp"

namespace farhand {
namespace {

TEST(Plan, DrawsScenesThatTheProgramsTakeAndEachThingAtSomeSeed) {
  std::map<std::string, int> drawn;
  for (std::uint64_t seed = 1; seed <= 300; ++seed) {
    const Plan plan = draw_plan(seed, std::chrono::seconds(30));
    const Scene scene = scene_of(plan);
    const auto field = check_fields(scene.proto), rule = check_rules(scene.proto);
    EXPECT_FALSE(field) << variant(plan) << field->field << field->what;
    EXPECT_FALSE(rule) << variant(plan) << rule->field << rule->what;
    ++drawn[plan.method];
    if (plan.keep_alive_ms) ++drawn[*plan.keep_alive_ms == 5 ? "5 ms" : "50 ms"];
    if (plan.alignment_deg) ++drawn[plan.scene + " aligned"];
    if (plan.method == "direct" && plan.keep_alive_ms) ++drawn["direct, left out"];
  }
  for (const char* what :
       {"damped", "mmt", "auto", "direct", "wave", "smith", "5 ms", "50 ms", "direct, left out",
        "minimal aligned", "twin_delta_closed aligned", "twin_delta_far aligned"})
    EXPECT_GE(drawn[what], 3) << what;
}

}  // namespace
}  // namespace farhand
