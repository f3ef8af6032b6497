#include "common/scene.hpp"

#include <gtest/gtest.h>
#include <unistd.h>

#include <algorithm>
#include <fstream>
#include <random>
#include <set>

#include "common/scene_rules.hpp"
#include "tests/common/broken_scenes.hpp"
#include "tests/common/broken_scenes_ahrs.hpp"

namespace farhand {
namespace {

namespace fs = std::filesystem;

const fs::path kScenes = fs::path(FARHAND_SOURCE_DIR) / "deploy/scenes";

// The refusal, or nothing when the scene is accepted.
std::optional<SceneError> refusal(const std::string& text) {
  try {
    parse_scene(text, "test.textproto");
  } catch (const SceneError& error) {
    return error;
  }
  return {};
}

std::vector<fs::path> shipped() {
  std::vector<fs::path> out;
  for (const auto& entry : fs::directory_iterator(kScenes))
    if (entry.path().extension() == ".textproto") out.push_back(entry.path());
  return out;
}

struct Marked {
  std::string text;
  int line = 1;
  int column = 1;
};

Marked unmark(std::string text) {
  Marked out;
  const auto at = text.find('@');
  for (const char c : text.substr(0, at)) c == '\n' ? (++out.line, out.column = 1) : ++out.column;
  out.text = text.erase(at, 1);
  return out;
}

std::vector<BrokenScene> all_broken() {
  std::vector<BrokenScene> out = broken_scenes();
  for (BrokenScene& broken : broken_ahrs_scenes()) out.push_back(std::move(broken));
  return out;
}

TEST(Scene, IsRefusedAtTheRightPlaceWithARemedy) {
  for (const BrokenScene& broken : all_broken()) {
    const Marked m = unmark(broken.text);
    const auto error = refusal(m.text);
    ASSERT_TRUE(error) << "accepted: " << m.text;
    const std::string what = error->what();
    const std::string begins = "test.textproto:" + std::to_string(m.line) + ":" +
                               std::to_string(m.column) + ": " + broken.field + ": ";
    // What does not depend on a place in the text is told at its beginning.
    const bool whole = broken.text.back() == '@' && error->line == 1 && error->column == 1;
    EXPECT_TRUE(whole || what.starts_with(begins)) << what << "\ninstead of " << begins << "\nfor\n"
                                                   << m.text;
    EXPECT_EQ(error->field, broken.field) << what;
    EXPECT_NE(what.find(broken.says), std::string::npos) << what << "\nlacks: " << broken.says;
    EXPECT_NE(what.find("; "), std::string::npos) << what << "\nhas no remedy";
    EXPECT_EQ(what.find('\n'), std::string::npos) << what;
  }
}

// A Falcon's list of foreign fields is one rule here.
TEST(Scene, EveryRuleHasABrokenScene) {
  SceneRules rules;
  add_master_rules(rules);
  add_ahrs_rules(rules);
  add_slave_rules(rules);
  std::vector<SceneError> refusals;
  for (const BrokenScene& broken : all_broken())
    refusals.push_back(*refusal(unmark(broken.text).text));
  for (const SceneRule& rule : rules) {
    const bool falcon = rule.what.starts_with("means nothing on a Falcon");
    EXPECT_TRUE(std::any_of(
        refusals.begin(), refusals.end(),
        [&](const SceneError& error) {
          const bool blamed = falcon || rule.each || error.field.ends_with(rule.field);
          return blamed && std::string(error.what()).find(rule.what + "; " + rule.remedy) !=
                               std::string::npos;
        }))
        << rule.type->name() << "." << rule.field << " " << rule.what;
  }
}

TEST(Scene, EveryShippedOneLoads) {
  EXPECT_GE(shipped().size(), 11u);
  for (const auto& path : shipped()) EXPECT_NO_THROW(load_scene(path)) << path;
}

TEST(Scene, KeepsItsTextAndPath) {
  const Scene scene = load_scene(kScenes / "minimal.textproto");
  EXPECT_EQ(scene.path, (kScenes / "minimal.textproto").string());
  EXPECT_NE(scene.text.find("# The smallest teleoperation"), std::string::npos);
  EXPECT_TRUE(scene.proto.master().has_twin_delta());
  EXPECT_EQ(scene.shared_hash, shared_hash(scene.proto));
}

TEST(Scene, MissingFileDirectoryAndHugeFileAreRefused) {
  const auto says = [](const fs::path& path) -> std::string {
    try {
      load_scene(path);
    } catch (const SceneError& error) {
      return error.what();
    }
    return "accepted";
  };
  EXPECT_EQ(says("/nowhere/a.textproto"),
            "/nowhere/a.textproto:1:1: scene: the file cannot be opened; give the path of a scene "
            "file that exists and is readable");
  EXPECT_NE(says(kScenes).find("this is a directory"), std::string::npos);
  const fs::path huge = fs::temp_directory_path() / ("farhand_scene_" + std::to_string(::getpid()));
  std::ofstream(huge) << std::string(kMaxSceneBytes + 1, '#');
  EXPECT_NE(says(huge).find("larger than 1 MiB"), std::string::npos);
  fs::resize_file(huge, kMaxSceneBytes);
  EXPECT_NE(says(huge).find("nothing is in this file"), std::string::npos);
  fs::remove(huge);
}

TEST(Scene, LongOrMultilineValuesStillGiveOneReadableLine) {
  for (const auto& value :
       std::vector<std::string>{"'a\\\n b'", "\"a\nb\"", std::string(5000, 'x')}) {
    const auto error = refusal("rate_hz: " + value);
    ASSERT_TRUE(error);
    EXPECT_EQ(std::string(error->what()).find('\n'), std::string::npos) << error->what();
    EXPECT_LT(std::string(error->what()).size(), 200u) << error->what();
  }
}

TEST(Scene, WindowsLineEndsAngleBracketsAndListsOfMessagesAreFine) {
  EXPECT_FALSE(
      refusal("master <\r\n twin_delta <>\r\n sim_hand < push [ <at_s: 1, force_newton: [1, 2, 3]> "
              "] >\r\n>\r\n"
              "slave { sim_arm { friction: 1; rate_hz: 2e3 } workspace: {} joint_pid {} }"));
}

// A legal value that only looks odd must not be blamed for a fault further on.
TEST(Scene, OddButLegalValuesAreNotBlamed) {
  const auto error = refusal(
      "seed: 0x10 rate_hz: 1e3f master { falcon { geometry: 1 } }\n slave { sim_arm { friction: t "
      "} } nonsense: 1");
  ASSERT_TRUE(error);
  EXPECT_EQ(error->field, "nonsense") << error->what();
}

TEST(Scene, TruncatedAndDamagedTextIsRefusedOrReadButNeverBreaks) {
  const std::string full = load_scene(kScenes / "full.textproto").text;
  const auto lines = std::count(full.begin(), full.end(), '\n') + 1;
  const auto look = [&](const std::string& text, const std::string& how) {
    if (const auto error = refusal(text)) {
      EXPECT_TRUE(error->line >= 1 && error->line <= lines + 1 && error->column >= 1)
          << how << ": " << error->what();
      EXPECT_EQ(std::string(error->what()).find('\n'), std::string::npos) << how;
    }
  };
  for (std::size_t n = 0; n < full.size(); n += 3)
    look(full.substr(0, n), "cut at " + std::to_string(n));
  constexpr unsigned kSeed = 20240611;
  std::mt19937 random(kSeed);
  constexpr std::string_view kBytes = "{}<>[]:;,-.\"'#\n 0e9xmaster\x01\xff";
  for (int i = 0; i < 1500; ++i) {
    std::string text = full;
    for (int k = 0; k < 3; ++k) text[random() % text.size()] = kBytes[random() % kBytes.size()];
    look(text, "seed " + std::to_string(kSeed) + " damage " + std::to_string(i));
  }
}

TEST(Scene, DeeplyNestedNonsenseIsRefusedAtOnce) {
  for (const std::string piece : {"a{", "master{", "[", "master:[", "master<"}) {
    std::string text;
    while (text.size() < kMaxSceneBytes - 10) text += piece;
    EXPECT_TRUE(refusal(text)) << piece;
  }
}

TEST(SceneHash, IsTheSameForTheSameSceneWrittenOtherwise) {
  const Scene a = parse_scene(
      "rate_hz: 500 master { twin_delta {} sim_hand {} } slave { sim_arm {} workspace {} joint_pid "
      "{} }",
      "a");
  const Scene b = parse_scene(
      "slave { joint_pid {} workspace { scale: 1 } sim_arm { friction: false } }\nseed: 9\n# "
      "remark\n"
      "master { sim_hand { device_mass_kg: 2 } twin_delta {} } rate_hz: 5e2 duration_s: 3",
      "b");
  EXPECT_EQ(a.shared_hash, b.shared_hash);
}

TEST(SceneHash, TellsPresenceAndHandlesApart) {
  const auto hash = [](const std::string& master, const std::string& slave) {
    return parse_scene("master { sim_hand {} " + master + " } slave { workspace {} joint_pid {} " +
                           slave + " }",
                       "x")
        .shared_hash;
  };
  const std::set<std::uint64_t> all = {
      hash("twin_delta {}", "sim_arm {}"), hash("falcon {}", "sim_arm {}"),
      hash("falcon { geometry: TABLE1_S0 }", "sim_arm {}"),
      hash("falcon {} force_feedback {}", "sim_arm { force_sensor {} } force_sensing {}"),
      hash("twin_delta {} force_feedback {}", "sim_arm { force_sensor {} } force_sensing {}")};
  EXPECT_EQ(all.size(), 5u);
}

TEST(SceneHash, TakesMinusZeroForZero) {
  proto::Scene a, b;
  a.mutable_master()->mutable_falcon()->set_angle_offset_deg(0.0);
  b.mutable_master()->mutable_falcon()->set_angle_offset_deg(-0.0);
  EXPECT_EQ(shared_hash(a), shared_hash(b));
}

}  // namespace
}  // namespace farhand
