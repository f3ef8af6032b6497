#include "common/report/report.hpp"

#include <gtest/gtest.h>

#include <filesystem>
#include <fstream>
#include <regex>
#include <sstream>

#include "common/report/charts.hpp"
#include "common/report/run_file.hpp"
#include "tests/support/synthetic_run.hpp"
#include "tests/support/temporary_file.hpp"

namespace farhand {
namespace {

std::string read(const std::string& path) {
  std::ifstream in(path, std::ios::binary);
  std::stringstream text;
  text << in.rdbuf();
  return text.str();
}

std::string contact_scene() {
  return read(FARHAND_SOURCE_DIR "/deploy/scenes/twin_delta_contact.textproto");
}

std::size_t count(const std::string& text, const std::string& what) {
  std::size_t n = 0;
  for (std::size_t at = text.find(what); at != std::string::npos; at = text.find(what, at + 1)) ++n;
  return n;
}

RunData read_quietly(const std::string& path) {
  return read_run(path, [](double) {});
}

TEST(Report, NoRequestLeavesThePage) {
  RunData run = synthetic_loopback({});
  run.scene_text = contact_scene();
  run.scene_path = "contact.textproto";
  const std::string page = report_html({run});
  EXPECT_EQ(count(page, "://"), count(page, "xmlns=\"http://www.w3.org/2000/svg\""));
  for (const char* reference : {"src=", "href", "url(", "@import", "<script", "<link", "<iframe",
                                "<img", "<object", "srcset", "<base", "<form"})
    EXPECT_EQ(count(page, reference), 0u) << reference;
}

TEST(Report, EveryTagIsClosed) {
  RunData run = synthetic_loopback({});
  run.scene_text = contact_scene();
  const std::string page = report_html({run, synthetic_master({})});
  for (const char* tag : {"svg", "g", "text", "table", "tr", "td", "th", "div", "figure", "section",
                          "p", "h2", "span"})
    EXPECT_EQ(count(page, std::string("<") + tag + ">") + count(page, std::string("<") + tag + " "),
              count(page, std::string("</") + tag + ">"))
        << tag;
  EXPECT_EQ(count(page, "nan"), 0u);
}

TEST(Report, NamesOfFilesAndScenesAreEscaped) {
  RunData run = synthetic_loopback({});
  run.scene_path = "a<b>&\"c\".textproto";
  run.files = {"<script>.mcap"};
  run.notes = {"<i>"};
  const std::string page = report_html({run});
  EXPECT_EQ(page.find("a<b>"), std::string::npos);
  EXPECT_EQ(page.find("<script>"), std::string::npos);
  EXPECT_EQ(page.find("<i>"), std::string::npos);
  EXPECT_NE(page.find("a&lt;b&gt;&amp;&quot;c&quot;"), std::string::npos);
}

TEST(Report, ChartsOfSeveralRunsStandSideBySide) {
  const std::string one = report_html({synthetic_loopback({})});
  const std::string two = report_html({synthetic_loopback({}), synthetic_loopback({})});
  EXPECT_EQ(count(two, "<figure"), 2 * count(one, "<figure"));
}

TEST(Report, LimitsComeFromTheRecordedScene) {
  RunData run = synthetic_loopback({});
  EXPECT_FALSE(limits_of(run).has_value());
  run.scene_text = contact_scene();
  ASSERT_TRUE(limits_of(run).has_value());
  EXPECT_EQ(limits_of(run)->period_s, 1e-3);
  run.scene_text = "rate_hz: nonsense";
  EXPECT_FALSE(limits_of(run).has_value());
}

TEST(Report, RangesOfTheJointsComeFromTheSlavesRecording) {
  RunData run = synthetic_loopback({});
  EXPECT_FALSE(joint_ranges(run).has_value());
  run.metadata["robot"] = {{"q_lower_rad", "-1 -2 -3 -4 -5 -6.5"},
                           {"q_upper_rad", "1 2 3 4 5 6.5"},
                           {"joint_torque_nm", "60 60 40 15 15 8"}};
  ASSERT_TRUE(joint_ranges(run).has_value());
  EXPECT_EQ(joint_ranges(run)->q_lower[5], -6.5);
  EXPECT_EQ(joint_ranges(run)->torque[2], 40);
  run.metadata["robot"]["q_upper_rad"] = "1 2 3";
  EXPECT_FALSE(joint_ranges(run).has_value());
}

TEST(Report, AShortRunHasAPage) {
  SyntheticRun made;
  made.ticks = 1;
  EXPECT_NE(report_html({synthetic_loopback(made)}).find("</html>"), std::string::npos);
}

TEST(RunFile, IsReadBackTickByTick) {
  const SyntheticRun made;
  const TemporaryFile file("", ".mcap");
  write_synthetic(made, file.path(), contact_scene());
  const RunData run = read_quietly(file.path());
  ASSERT_TRUE(run.master && run.slave);
  EXPECT_EQ(run.master->size(), 2000u);
  EXPECT_EQ(run.slave->size(), 2000u);
  EXPECT_EQ(run.role, "loopback");
  EXPECT_EQ(run.scene_text, contact_scene());
  EXPECT_TRUE(run.notes.empty());
  EXPECT_EQ(run.master->work.back(), synthetic_loopback(made).master->work.back());
}

TEST(RunFile, CutOffIsReadAsFarAsItGoesAndSaysSo) {
  const TemporaryFile file("", ".mcap");
  write_synthetic({}, file.path(), contact_scene());
  std::filesystem::resize_file(file.path(), std::filesystem::file_size(file.path()) * 6 / 10);
  const RunData run = read_quietly(file.path());
  ASSERT_TRUE(run.master.has_value());
  EXPECT_LT(run.master->size(), 2000u);
  ASSERT_FALSE(run.notes.empty());
  EXPECT_NE(report_html({run}).find("cut off"), std::string::npos);
}

TEST(RunFile, OfSomethingElseIsRefusedInASentence) {
  const TemporaryFile text("t_s,x_m\n", ".csv");
  EXPECT_NE(refusal([&] { read_quietly(text.path()); }).find(text.path()), std::string::npos);
  const TemporaryFile empty("", ".mcap");
  McapWriter(empty.path(), "other").close();
  EXPECT_NE(refusal([&] { read_quietly(empty.path()); }).find("--record"), std::string::npos);
}

}  // namespace
}  // namespace farhand
