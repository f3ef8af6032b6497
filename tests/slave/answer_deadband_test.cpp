#include "slave/answer_deadband.hpp"

#include <gtest/gtest.h>

#include <limits>
#include <vector>

namespace farhand {
namespace {

using std::chrono::milliseconds;

constexpr AnswerDeadbandConfig kConfig{
    .force = {.share = 0.1, .floor = 0.2, .keep_alive = milliseconds(20)},
    .torque = {.share = 0.1, .floor = 0.01, .keep_alive = milliseconds(20)}};

struct Rig {
  AnswerDeadband deadband{kConfig};
  SlaveToMaster out;
  TimePoint now{std::chrono::seconds(1)};
  bool wanted = true;

  bool due() { return deadband.due(out, wanted, now += milliseconds(1)); }
  // An answer, and all that repeat it.
  void settle() {
    for (int i = 0; i < 12; ++i) due();
  }
};

TEST(AnswerDeadband, SendsTheFirstAndThenOnlyToKeepTheLinkAlive) {
  Rig rig;
  rig.settle();
  int sent = 0;
  for (int i = 0; i < 200; ++i) sent += rig.due();
  EXPECT_EQ(sent, 10);
}

TEST(AnswerDeadband, SaysNewsAgainForTheFirstMayBeLost) {
  Rig rig;
  rig.settle();
  rig.out.mode = Mode::ready;
  std::vector<int> sent;
  for (int ms = 0; ms < 20; ++ms)
    if (rig.due()) sent.push_back(ms);
  EXPECT_EQ(sent, (std::vector<int>{0, 2, 5, 10}));
}

TEST(AnswerDeadband, SendsAForceOrTorqueThatWouldBeFelt) {
  Rig rig;
  rig.settle();
  rig.out.F_E_M.force.x() = 0.19;
  EXPECT_FALSE(rig.due());
  rig.out.F_E_M.force.x() = 10;
  EXPECT_TRUE(rig.due());
  rig.settle();
  rig.out.F_E_M.force.x() = 10.9;  // a tenth of what is felt
  EXPECT_FALSE(rig.due());
  rig.out.F_E_M.force.x() = 11.1;
  EXPECT_TRUE(rig.due());
  rig.out.F_E_M.torque.z() = 0.02;
  EXPECT_TRUE(rig.due());
}

TEST(AnswerDeadband, ANumberThatIsNoneIsNews) {
  Rig rig;
  rig.settle();
  rig.out.F_E_M.force.x() = std::numeric_limits<double>::quiet_NaN();
  EXPECT_TRUE(rig.due());
}

TEST(AnswerDeadband, SendsWhateverTheMasterActsBy) {
  Rig rig;
  rig.settle();
  rig.out.mode = Mode::engaged;
  EXPECT_TRUE(rig.due());
  rig.out.reason = Reason::none;
  EXPECT_TRUE(rig.due());
  rig.out.coupled = true;
  EXPECT_TRUE(rig.due());
  rig.out.has_robot = true;
  EXPECT_TRUE(rig.due());
  rig.out.dead_man_presses_seen = 1;
  EXPECT_TRUE(rig.due());
  rig.out.clutch_presses_seen = 1;
  EXPECT_TRUE(rig.due());
  rig.settle();
  rig.out.limits = 1;
  rig.out.p_SE.x() = 1;
  EXPECT_FALSE(rig.due());
}

TEST(AnswerDeadband, AForceThatNobodyFeelsIsNoNews) {
  Rig rig;
  rig.wanted = false;
  rig.settle();
  rig.out.F_E_M.force.x() = 10;
  EXPECT_FALSE(rig.due());
}

}  // namespace
}  // namespace farhand
