#include "common/loop_watch.hpp"

#include <gtest/gtest.h>
#include <spdlog/sinks/ostream_sink.h>
#include <spdlog/spdlog.h>

#include <numbers>
#include <sstream>
#include <vector>

namespace farhand {
namespace {

using std::chrono::milliseconds;

struct Tick {
  TimePoint now{std::chrono::hours(1)};
  Mode mode = Mode::disconnected;
  Reason reason = Reason::no_partner;
  bool aligned = true;
  Vec3 turn_M = Vec3::Zero();
};

// What a watch writes to the log.
class LoopWatchLog : public testing::Test {
 protected:
  void SetUp() override {
    const auto sink = std::make_shared<spdlog::sinks::ostream_sink_st>(log_);
    sink->set_pattern("%v");
    spdlog::set_default_logger(std::make_shared<spdlog::logger>("", sink));
  }
  void TearDown() override { spdlog::set_default_logger(before_); }

  void run(LoopWatch& watch, int ms) {
    for (int k = 0; k < ms; ++k, tick_.now += milliseconds(1))
      watch.add(tick_, {}, {}, [] { return std::string("a line"); });
  }
  void turn(double degrees) { tick_.turn_M.x() = degrees * std::numbers::pi / 180; }
  std::vector<std::string> lines() {
    std::vector<std::string> out;
    for (std::string line; std::getline(log_, line);) out.push_back(line);
    log_.clear();
    return out;
  }

  Tick tick_;

 private:
  std::shared_ptr<spdlog::logger> before_ = spdlog::default_logger();
  std::stringstream log_;
};

TEST_F(LoopWatchLog, WithoutALiveLineTellsHowToTurnOnceASecondAndOnlyNews) {
  LoopWatch watch(0, true);
  tick_.mode = Mode::aligning, tick_.reason = Reason::turn_handle, tick_.aligned = false;
  for (int k = 0; k < 30; ++k) turn(30 - k), run(watch, 100);
  const auto told = lines();
  ASSERT_EQ(told.size(), 3u);
  EXPECT_EQ(told[0].substr(0, 45), "DISCONNECTED -> ALIGNING: turn the handle 30 ");
  EXPECT_EQ(told[1].substr(0, 29), "ALIGNING: turn the handle 20 ");
  EXPECT_EQ(told[2].substr(0, 29), "ALIGNING: turn the handle 10 ");
  run(watch, 5000);  // held still: the last angle, once
  EXPECT_EQ(lines().size(), 1u);
}

TEST_F(LoopWatchLog, UnderTheClutchToo) {
  LoopWatch watch(0, true);
  tick_.mode = Mode::engaged, tick_.reason = Reason::none;
  run(watch, 10);
  EXPECT_EQ(lines().size(), 1u);
  for (int k = 0; k < 2; ++k) {  // turned away, and again after it was parallel
    tick_.aligned = false;
    turn(20);
    run(watch, 3000);
    EXPECT_EQ(lines(), std::vector<std::string>{
                           "ENGAGED: turn the handle 20 deg about +x (its top to the left)"});
    tick_.aligned = true;
    run(watch, 3000);
    EXPECT_TRUE(lines().empty());
  }
}

TEST_F(LoopWatchLog, WithALiveLineTellsChangesAlone) {
  LoopWatch watch(0, false);
  tick_.mode = Mode::aligning, tick_.reason = Reason::turn_handle, tick_.aligned = false;
  for (int k = 0; k < 30; ++k) turn(30 - k), run(watch, 100);
  EXPECT_EQ(lines().size(), 1u);
}

}  // namespace
}  // namespace farhand
