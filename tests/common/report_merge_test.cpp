#include <gtest/gtest.h>

#include "common/report/merge.hpp"
#include "tests/support/synthetic_run.hpp"

namespace farhand {
namespace {

constexpr std::int64_t kSecond = 1'000'000'000;

TEST(MergeRuns, TwoFilesOfARunBecomeOneOnTheMastersClock) {
  const SyntheticRun made;
  // Clocks 7 s apart, and machines whose wall clocks disagree by 300 s.
  for (const bool slave_first : {false, true}) {
    RunData master = synthetic_master(made, 7 * kSecond);
    RunData slave = synthetic_slave(made, 7 * kSecond, 300 * kSecond);
    std::vector<RunData> both;
    both.push_back(slave_first ? slave : master);
    both.push_back(slave_first ? master : slave);
    const auto runs = merge_runs(std::move(both));
    ASSERT_EQ(runs.size(), 1u);
    ASSERT_TRUE(runs[0].master && runs[0].slave);
    for (std::size_t i = 0; i < runs[0].master->size(); i += 100)
      EXPECT_NEAR(runs[0].master->t[i], runs[0].slave->t[i], 1e-9) << i;
    EXPECT_EQ(runs[0].files.size(), 2u);
  }
}

TEST(MergeRuns, ASideThatBeganEarlierSetsTheStart) {
  SyntheticRun made;
  RunData master = synthetic_master(made);
  made.start_ns -= kSecond / 2;
  const auto runs = merge_runs({master, synthetic_slave(made)});
  ASSERT_EQ(runs.size(), 1u);
  EXPECT_NEAR(runs[0].slave->t.front(), 0, 1e-9);
  EXPECT_NEAR(runs[0].master->t.front(), 0.5, 1e-9);
}

TEST(MergeRuns, OtherScenesRolesOrTimesStayApart) {
  SyntheticRun made;
  RunData other_scene = synthetic_slave(made);
  other_scene.scene_hash = "2";
  EXPECT_EQ(merge_runs({synthetic_master(made), other_scene}).size(), 2u);
  EXPECT_EQ(merge_runs({synthetic_master(made), synthetic_master(made)}).size(), 2u);
  SyntheticRun later = made;
  later.start_ns += 100 * kSecond;
  EXPECT_EQ(merge_runs({synthetic_master(made), synthetic_slave(later)}).size(), 2u);
}

TEST(MergeRuns, TwoRunsOfTwoFilesFindTheirOwnPartners) {
  SyntheticRun first, second;
  second.start_ns += 100 * kSecond;
  const auto runs = merge_runs({synthetic_master(first), synthetic_master(second),
                                synthetic_slave(second), synthetic_slave(first)});
  ASSERT_EQ(runs.size(), 2u);
  EXPECT_EQ(runs[0].slave->start_ns, first.start_ns);
  EXPECT_EQ(runs[1].slave->start_ns, second.start_ns);
}

TEST(ShiftToMaster, FallsBackToTheWallClocks) {
  const SyntheticRun made;
  RunData master = synthetic_master(made), slave = synthetic_slave(made);
  slave.epoch_minus_monotonic_ns = 5;
  master.master->clock_offset_ns.clear();
  slave.slave->clock_offset_ns.clear();
  EXPECT_EQ(shift_to_master(master, slave), 0);
}

}  // namespace
}  // namespace farhand
