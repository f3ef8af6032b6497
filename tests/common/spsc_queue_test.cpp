#include "common/spsc_queue.hpp"

#include <gtest/gtest.h>

#include <thread>

#include "common/recorder.hpp"

namespace farhand {
namespace {

// False, and nothing stored, when full.
template <typename T>
bool push(SpscQueue<T>& q, const T& value) {
  T* slot = q.slot();
  if (slot == nullptr) return false;
  *slot = value;
  q.commit();
  return true;
}

TEST(SpscQueue, RefusesWhenFullAndLosesNothing) {
  SpscQueue<int> q(4);
  for (int i = 0; i < 4; ++i) EXPECT_TRUE(push(q, i));
  EXPECT_FALSE(push(q, 9));
  for (int i = 0; i < 4; ++i) {
    ASSERT_NE(q.front(), nullptr);
    EXPECT_EQ(*q.front(), i);
    q.pop();
  }
  EXPECT_EQ(q.front(), nullptr);
  EXPECT_TRUE(push(q, 7));
}

TEST(SpscQueue, TwoThreadsSeeEveryElementInOrder) {
  SpscQueue<std::uint64_t> q(64);
  constexpr std::uint64_t kCount = 300000;
  std::thread producer([&] {
    for (std::uint64_t i = 0; i < kCount;)
      if (push(q, i)) ++i;
  });
  for (std::uint64_t expected = 0; expected < kCount;) {
    if (const std::uint64_t* x = q.front()) {
      ASSERT_EQ(*x, expected++);
      q.pop();
    }
  }
  producer.join();
}

TEST(Recorder, DeliversEveryRecordBeforeItStops) {
  std::vector<int> seen;
  {
    Recorder<int> recorder([&](const int& x) { seen.push_back(x); });
    for (int i = 0; i < 1000; ++i) recorder.slot() = i, recorder.commit();
    recorder.stop();
    EXPECT_EQ(recorder.lost(), 0u);
  }
  ASSERT_EQ(seen.size(), 1000u);
  EXPECT_EQ(seen.back(), 999);
}

TEST(Recorder, AStuckSinkCostsRecordsAndCountsThem) {
  std::atomic<bool> hold{true};
  std::size_t seen = 0;
  Recorder<int> recorder([&](const int&) {
    while (hold) std::this_thread::yield();
    ++seen;
  });
  constexpr int kPushed = 3 * static_cast<int>(Recorder<int>::kCapacity);
  for (int i = 0; i < kPushed; ++i) recorder.slot() = i, recorder.commit();
  EXPECT_GT(recorder.lost(), 0u);
  hold = false;
  recorder.stop();
  EXPECT_EQ(seen + recorder.lost(), static_cast<std::size_t>(kPushed));
}

}  // namespace
}  // namespace farhand
