#include "common/mode.hpp"

#include <gtest/gtest.h>

namespace farhand {
namespace {

constexpr Mode kModes[] = {Mode::idle, Mode::ready, Mode::engaged, Mode::holding};

ModeInputs inputs(int bits) {
  return {(bits & 1) != 0, (bits & 2) != 0, (bits & 4) != 0, (bits & 8) != 0, (bits & 16) != 0};
}

TEST(Mode, EveryStateWithEveryInputMovesOnlyAlongTheTable) {
  for (Mode from : kModes)
    for (int bits = 0; bits < 32; ++bits) {
      const Mode to = next_mode(from, inputs(bits));
      EXPECT_TRUE(is_legal(from, to))
          << to_string(from) << " -> " << to_string(to) << " on " << bits;
    }
}

TEST(Mode, EngagedNeedsEverythingAndTheDeadManHeld) {
  for (Mode from : kModes)
    for (int bits = 0; bits < 32; ++bits)
      EXPECT_TRUE(next_mode(from, inputs(bits)) != Mode::engaged || bits == 31)
          << to_string(from) << " " << bits;
}

TEST(Mode, NothingResumesWhileTheDeadManStaysPressed) {
  const ModeInputs good{true, true, true, true, true};
  for (Mode from : {Mode::idle, Mode::holding}) {
    Mode mode = from;
    for (int k = 0; k < 100; ++k) mode = next_mode(mode, good);
    EXPECT_EQ(mode, from);
    ModeInputs released = good;
    released.dead_man = false;
    mode = next_mode(mode, released);
    EXPECT_EQ(mode, Mode::ready);
    EXPECT_EQ(next_mode(mode, good), Mode::engaged);
  }
}

TEST(Mode, AnAgedLinkHoldsAndALostOneIdles) {
  EXPECT_EQ(next_mode(Mode::engaged, {true, true, false, true, true}), Mode::holding);
  EXPECT_EQ(next_mode(Mode::holding, {true, true, false, true, false}), Mode::holding);
  EXPECT_EQ(next_mode(Mode::holding, {true, false, false, true, true}), Mode::idle);
  EXPECT_EQ(next_mode(Mode::engaged, {false, true, true, true, true}), Mode::idle);
}

}  // namespace
}  // namespace farhand
