#include "common/newest.hpp"

#include <gtest/gtest.h>

#include <thread>

namespace farhand {
namespace {

TEST(Newest, GivesTheLastValueOnce) {
  Newest<int> newest;
  EXPECT_EQ(newest.take(), nullptr);
  newest.put(1);
  newest.put(2);
  const int* taken = newest.take();
  ASSERT_NE(taken, nullptr);
  EXPECT_EQ(*taken, 2);
  EXPECT_EQ(newest.take(), nullptr);
}

TEST(Newest, AValueTakenStaysWhileOthersArePut) {
  Newest<int> newest;
  newest.put(1);
  const int* taken = newest.take();
  ASSERT_NE(taken, nullptr);
  for (int i = 2; i < 10; ++i) newest.put(i);
  EXPECT_EQ(*taken, 1);
  EXPECT_EQ(*newest.take(), 9);
}

// Both halves are written together and must be seen together, never going back.
TEST(Newest, BetweenThreadsValuesAreWholeAndInOrder) {
  struct Pair {
    std::uint64_t a = 0, b = 0;
  };
  constexpr std::uint64_t kValues = 200000;
  Newest<Pair> newest;
  std::thread writer([&] {
    for (std::uint64_t i = 1; i <= kValues; ++i) newest.put({i, 3 * i});
  });
  std::uint64_t last = 0, torn = 0, backwards = 0;
  while (last < kValues) {
    const Pair* p = newest.take();
    if (p == nullptr) continue;
    torn += p->b != 3 * p->a;
    backwards += p->a <= last;
    last = p->a;
  }
  writer.join();
  EXPECT_EQ(torn, 0u);
  EXPECT_EQ(backwards, 0u);
}

}  // namespace
}  // namespace farhand
