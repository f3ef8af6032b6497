#include "common/sequence_window.hpp"

#include <gtest/gtest.h>

#include <limits>
#include <set>
#include <vector>

#include "common/random.hpp"

namespace farhand {
namespace {

using Place = SequenceWindow::Place;
constexpr std::uint64_t kSpan = SequenceWindow::kSpan;
constexpr std::uint64_t kMax = std::numeric_limits<std::uint64_t>::max();

struct Step {
  std::uint64_t sequence;
  Place place;
};

void check(const std::vector<Step>& steps) {
  SequenceWindow window;
  for (std::size_t i = 0; i < steps.size(); ++i)
    EXPECT_EQ(window.admit(steps[i].sequence), steps[i].place)
        << "step " << i << ", sequence " << steps[i].sequence;
}

TEST(SequenceWindow, EdgesOfTheWindow) {
  check({{1, Place::newest},
         {1, Place::duplicate},
         {kSpan, Place::newest},
         {2, Place::late},
         {1, Place::duplicate},
         {kSpan + 1, Place::newest},
         {1, Place::too_old},
         {2, Place::duplicate},
         {3, Place::late},
         {kSpan + 3, Place::newest},
         {3, Place::too_old},
         {4, Place::late},
         {4, Place::duplicate},
         {kSpan + 2, Place::late},
         {kSpan + 2, Place::duplicate},
         {kSpan + 3, Place::duplicate}});
}

TEST(SequenceWindow, EdgesOfItsWords) {
  check({{63, Place::newest},
         {64, Place::newest},
         {65, Place::newest},
         {64, Place::duplicate},
         {127, Place::newest},
         {128, Place::newest},
         {126, Place::late},
         {128 + kSpan - 1, Place::newest},
         {128, Place::duplicate},
         {127, Place::too_old},
         {129, Place::late},
         {64 * 17 + 128, Place::newest},  // the word of 128 again, one turn later
         {64 * 17 + 127, Place::late},
         {64 * 17 + 128, Place::duplicate}});
}

TEST(SequenceWindow, JumpsForgetWhatIsBehind) {
  check({{5, Place::newest},
         {1000000, Place::newest},
         {5, Place::too_old},
         {999999, Place::late},
         {1000000 - kSpan + 1, Place::late},
         {1000000 - kSpan, Place::too_old},
         {kMax, Place::newest},
         {kMax, Place::duplicate},
         {kMax - 1, Place::late},
         {kMax - kSpan + 1, Place::late},
         {kMax - kSpan, Place::too_old},
         {1000000, Place::too_old},
         {0, Place::too_old}});
}

TEST(SequenceWindow, MayStartAnywhere) {
  check({{kMax - 1, Place::newest}, {kMax - 2, Place::late}, {kMax, Place::newest}});
  check({{0, Place::newest}, {0, Place::duplicate}, {1, Place::newest}});
  check({{100, Place::newest}, {0, Place::late}, {0, Place::duplicate}});
}

TEST(SequenceWindow, SkippedCountsHolesUntilTheyAreFilled) {
  SequenceWindow window;
  const auto skipped_after = [&](std::uint64_t sequence) {
    window.admit(sequence);
    return window.skipped();
  };
  EXPECT_EQ(skipped_after(10), 0u);  // what was before is not ours to miss
  EXPECT_EQ(skipped_after(9), 0u);
  EXPECT_EQ(skipped_after(11), 0u);
  EXPECT_EQ(skipped_after(15), 3u);
  EXPECT_EQ(skipped_after(13), 2u);
  EXPECT_EQ(skipped_after(13), 2u);
  EXPECT_EQ(skipped_after(12), 1u);
  EXPECT_EQ(skipped_after(14 + kSpan * 2), 1 + kSpan * 2 - 2);
  EXPECT_EQ(skipped_after(14), 1 + kSpan * 2 - 2);  // too late to count
}

TEST(SequenceWindow, AgreesWithASetOverRandomWalks) {
  for (std::uint64_t seed = 1; seed <= 20; ++seed) {
    Random random(seed);
    SequenceWindow window;
    std::set<std::uint64_t> seen;
    std::uint64_t top = 0;
    for (int i = 0; i < 20000; ++i) {
      const std::uint64_t reach = random.uniform() < 0.01 ? 5 * kSpan : seed * 4;
      const std::uint64_t base = top + reach / 2 > kSpan * 6 ? top + reach / 2 : kSpan * 6;
      const std::uint64_t sequence = base - random.bits() % (reach + kSpan / 8);
      const Place expected = seen.empty() || sequence > top ? Place::newest
                             : top - sequence >= kSpan      ? Place::too_old
                             : seen.contains(sequence)      ? Place::duplicate
                                                            : Place::late;
      ASSERT_EQ(window.admit(sequence), expected) << "seed " << seed << " step " << i;
      if (expected != Place::too_old) seen.insert(sequence);
      top = *seen.rbegin();
      ASSERT_EQ(window.highest(), top);
    }
  }
}

}  // namespace
}  // namespace farhand
