#include "common/processors.hpp"

#include <gtest/gtest.h>

#include <cerrno>
#include <thread>

#include "tests/support/temporary_file.hpp"

namespace farhand {
namespace {

// On a thread of its own, so that the others of this test stay where they are.
template <typename F>
void apart(F&& f) {
  std::thread(f).join();
}

TEST(Processors, AreReadAsTheKernelWritesThem) {
  EXPECT_EQ(parse_processors("0-3,6"), (Processors{0, 1, 2, 3, 6}));
  EXPECT_EQ(parse_processors("5"), Processors{5});
  EXPECT_EQ(parse_processors(""), Processors{});
  for (const char* bad : {"a", "-1", "1-", "3-2", "1,,2", "0-1024", "99999999999", "1 2"})
    EXPECT_FALSE(parse_processors(bad)) << bad;
}

TEST(Processors, AreWrittenAsTheyAreRead) {
  for (const char* text : {"", "0", "0-1", "0-3,6", "1,3,5-7"})
    EXPECT_EQ(to_string(*parse_processors(text)), text);
}

TEST(Processors, AThreadRunsWhereItIsTold) {
  apart([] {
    const int one = own_processors().back();
    ASSERT_EQ(run_on({one}), 0);
    EXPECT_EQ(own_processors(), Processors{one});
  });
}

TEST(Processors, OneThatIsNotThereIsRefused) {
  apart([] {
    const Processors before = own_processors();
    EXPECT_EQ(run_on({1023}), EINVAL);
    EXPECT_EQ(own_processors(), before);
    EXPECT_NE(refusal([] { reserve_processor(1023); }).find("there is no processor 1023"),
              std::string::npos);
    EXPECT_EQ(own_processors(), before);
  });
}

TEST(Processors, RefusalsNameTheRemedy) {
  EXPECT_NE(processor_refusal(0, EINVAL).find("AllowedCPUs"), std::string::npos);
  EXPECT_NE(processor_refusal(0, EPERM).find("sched_setaffinity"), std::string::npos);
}

TEST(Processors, AReservedOneIsLeftToTheLoopByThreadsStartedSince) {
  apart([] {
    const Processors before = own_processors();
    const int kept = before.back();
    reserve_processor(kept);
    Processors others = before;
    if (others.size() > 1) others.pop_back();
    EXPECT_EQ(own_processors(), others);
    apart([&] { EXPECT_EQ(own_processors(), others); });
    EXPECT_EQ(run_on({kept}), 0);
  });
}

}  // namespace
}  // namespace farhand
