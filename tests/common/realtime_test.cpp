#include "common/realtime.hpp"

#include <gtest/gtest.h>
#include <sys/mman.h>

#include <cerrno>
#include <thread>

#include "common/processors.hpp"
#include "common/scene_realtime.hpp"

namespace farhand {
namespace {

TEST(Realtime, SleepEndsNotBeforeItsInstantWhetherSpunOrNot) {
  using std::chrono::microseconds;
  for (const auto spin : {microseconds(0), microseconds(100), microseconds(10'000)}) {
    const TimePoint until = monotonic_now() + microseconds(2000);
    sleep_until(until, spin);
    EXPECT_GE(monotonic_now(), until);
    sleep_until(until, spin);  // has passed: returns
  }
}

TEST(Realtime, AProcessorThatIsNotThereIsRefusedInASentence) {
  std::vector<std::string> refused;
  std::thread([&] { refused = enter_realtime({.cpu = 1023}, 1); }).join();
  munlockall();
  ASSERT_FALSE(refused.empty());
  EXPECT_EQ(refused.front(), processor_refusal(1023, EINVAL));
}

TEST(Realtime, APriorityThatIsNoneIsRefused) {
  EXPECT_EQ(schedule_fifo(1000), EINVAL);
}

TEST(Realtime, RealHardwareRunsDegradedOnlyWhenTold) {
  const std::vector<std::string> refused{"no real-time scheduling (no): raise the limit"};
  EXPECT_FALSE(degraded_refusal(false, refused, false));
  EXPECT_FALSE(degraded_refusal(true, {}, false));
  EXPECT_FALSE(degraded_refusal(true, refused, true));
  const auto sentence = degraded_refusal(true, refused, false);
  ASSERT_TRUE(sentence);
  EXPECT_NE(sentence->find(refused.front()), std::string::npos);
  EXPECT_NE(sentence->find("allow_degraded: true"), std::string::npos);
}

TEST(Realtime, ASceneThatSaysNothingPinsAndSpinsNothing) {
  proto::Realtime words;
  const RealtimeConfig nothing = realtime_config(words);
  EXPECT_FALSE(nothing.cpu || nothing.allow_degraded);
  EXPECT_EQ(nothing.spin, Duration::zero());
  words.set_cpu(1);
  words.set_spin_us(80);
  words.set_allow_degraded(true);
  const RealtimeConfig all = realtime_config(words);
  EXPECT_EQ(all.cpu, 1);
  EXPECT_EQ(all.spin, std::chrono::microseconds(80));
  EXPECT_TRUE(all.allow_degraded);
}

}  // namespace
}  // namespace farhand
