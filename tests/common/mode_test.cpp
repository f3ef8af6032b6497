// The whole space: every state the machine can be in, with every input.
#include "common/mode.hpp"

#include <gtest/gtest.h>

#include <set>
#include <tuple>
#include <vector>

namespace farhand {
namespace {

using std::chrono::milliseconds;
constexpr TimePoint kNow{std::chrono::hours(1)};

std::vector<ModeInputs> all_inputs() {
  std::vector<ModeInputs> out;
  constexpr int kEquipments = 5;
  for (int i = 0; i < kEquipments << 9; ++i) {
    const int bits = i / kEquipments;
    const auto bit = [bits](int which) { return (bits >> which & 1) != 0; };
    out.push_back({.equipment = static_cast<Equipment>(i % kEquipments),
                   .connected = bit(0),
                   .synced = bit(1),
                   .fresh = bit(2),
                   .partner = static_cast<Partner>(bits >> 3 & 3),
                   .dead_man = bit(5),
                   .aligned = bit(6),
                   .reset = bit(7),
                   .stop = bit(8)});
  }
  return out;
}

// A failure is as old as it may be without, or just as old as makes a fault; READY and ENGAGED end
// with its first sample.
std::vector<ModeState> all_states() {
  std::vector<ModeState> out;
  for (std::size_t m = 0; m < kModes; ++m)
    for (std::size_t r = 0; r < kReasons; ++r)
      for (const bool fit : {false, true})
        for (const int ms : {-1, 49, 50}) {
          const Mode mode = static_cast<Mode>(m);
          if (ms >= 0 && (mode == Mode::ready || mode == Mode::engaged)) continue;
          out.push_back({mode, static_cast<Reason>(r), fit, ms >= 0, kNow - milliseconds(ms)});
        }
  return out;
}

// Time only matters relative to a failure's begin.
ModeState older(ModeState s, Duration by) {
  s.failing_since = s.failing ? s.failing_since - by : kNow;
  return s;
}

// Those that can come about, from the start by any inputs, at two speeds of time.
std::vector<ModeState> reachable_states() {
  const auto inputs = all_inputs();
  using Key = std::tuple<Mode, Reason, bool, bool, bool>;
  std::set<Key> seen;
  std::vector<ModeState> out, unexplored{ModeState{}};
  while (!unexplored.empty()) {
    const ModeState s = unexplored.back();
    unexplored.pop_back();
    for (const ModeInputs& in : inputs)
      for (const int ms : {1, 60}) {
        const ModeState to = next_mode(older(s, milliseconds(ms)), in, kNow);
        const bool old = to.failing && kNow - to.failing_since >= kFaultAfter;
        if (!seen.emplace(to.mode, to.reason, to.was_fit, to.failing, old).second) continue;
        out.push_back(to);
        unexplored.push_back(to);
      }
  }
  return out;
}

bool everything_good(const ModeInputs& in) {
  return in.equipment == Equipment::ok && in.connected && in.synced && in.fresh &&
         in.partner == Partner::able && in.aligned && !in.stop;
}

TEST(Mode, EveryStateIsReachedAndNoOtherReasonThanThoseOfItsKind) {
  std::set<Mode> modes;
  for (const ModeState& s : reachable_states()) {
    modes.insert(s.mode);
    const bool fine = s.mode == Mode::ready || s.mode == Mode::engaged;
    const bool failed = s.reason == Reason::silent || s.reason == Reason::implausible;
    EXPECT_TRUE(s.mode == Mode::holding || (s.reason == Reason::none) == fine);
    EXPECT_TRUE(s.mode != Mode::fault || (failed && s.was_fit));
  }
  EXPECT_EQ(modes.size(), kModes);
}

TEST(Mode, EveryStateWithEveryInputMovesOnlyAlongTheTable) {
  const auto inputs = all_inputs();
  std::size_t tried = 0;
  for (const ModeState& s : all_states())
    for (const ModeInputs& in : inputs) {
      const Mode to = next_mode(s, in, kNow).mode;
      ASSERT_TRUE(is_legal(s.mode, to)) << to_string(s.mode) << " -> " << to_string(to);
      ++tried;
    }
  printf("%zu states with every input: %zu transitions, 0 forbidden\n", all_states().size(), tried);
}

// No row or column of the table allows what never happens.
TEST(Mode, EveryLegalTransitionHappens) {
  bool seen[kModes][kModes] = {};
  const auto inputs = all_inputs();
  for (const ModeState& s : reachable_states())
    for (const ModeInputs& in : inputs)
      for (const int ms : {1, 60}) {
        const ModeState to = next_mode(older(s, milliseconds(ms)), in, kNow);
        seen[static_cast<int>(s.mode)][static_cast<int>(to.mode)] = true;
      }
  for (std::size_t from = 0; from < kModes; ++from)
    for (std::size_t to = 0; to < kModes; ++to)
      EXPECT_EQ(seen[from][to], is_legal(static_cast<Mode>(from), static_cast<Mode>(to)))
          << to_string(static_cast<Mode>(from)) << " -> " << to_string(static_cast<Mode>(to));
}

TEST(Mode, EngagedNeedsTheDeadManAndOnceThereOnlyWhatMotionNeeds) {
  const auto inputs = all_inputs();
  for (const ModeState& s : all_states())
    for (const ModeInputs& in : inputs) {
      if (next_mode(s, in, kNow).mode != Mode::engaged) continue;
      ASSERT_TRUE(in.dead_man && in.fresh && in.connected && !in.stop);
      ASSERT_TRUE(in.equipment == Equipment::ok && in.partner == Partner::able && in.aligned);
      ASSERT_TRUE(s.mode == Mode::engaged || (s.mode == Mode::ready && everything_good(in)));
    }
}

// What is past is no longer told: then it waits for the dead-man alone.
TEST(Mode, HoldingSaysWhatIsInTheWayNow) {
  const auto inputs = all_inputs();
  for (const ModeState& s : all_states())
    for (const ModeInputs& in : inputs) {
      const ModeState to = next_mode(s, in, kNow);
      if (to.mode != Mode::holding) continue;
      const bool clear = in.equipment == Equipment::ok && in.fresh && in.partner == Partner::able;
      ASSERT_EQ(to.reason == Reason::dead_man_held, clear) << to_string(s.mode);
      ASSERT_TRUE(!clear || in.dead_man);
      ASSERT_EQ(to.reason == Reason::link_old, in.equipment == Equipment::ok && !in.fresh);
    }
}

// Whatever happened: between leaving ENGAGED and entering it again the dead-man was released.
TEST(Mode, NothingResumesMotionWithoutAFreshPress) {
  const auto inputs = all_inputs();
  for (const ModeState& s : reachable_states()) {
    if (s.mode == Mode::ready || s.mode == Mode::engaged) continue;
    for (const ModeInputs& in : inputs)
      if (in.dead_man) {
        const Mode to = next_mode(s, in, kNow).mode;
        ASSERT_TRUE(to != Mode::ready && to != Mode::engaged) << to_string(s.mode);
      }
  }
}

TEST(Mode, TheGraverWins) {
  const auto inputs = all_inputs();
  for (const ModeState& s : all_states())
    for (const ModeInputs& in : inputs) {
      const ModeState to = next_mode(s, in, kNow);
      const bool failing =
          in.equipment == Equipment::silent || in.equipment == Equipment::implausible;
      const bool stop = in.stop || s.mode == Mode::stopped;
      const bool failed = failing && to.was_fit && kNow - to.failing_since >= kFaultAfter;
      const bool latched = s.mode == Mode::fault && (failing || !in.reset);
      const Mode expected = stop                ? Mode::stopped
                            : failed || latched ? Mode::fault
                            : !in.connected     ? Mode::disconnected
                                                : to.mode;
      ASSERT_EQ(to.mode, expected) << to_string(s.mode);
    }
}

TEST(Mode, AFaultIsLeftOnlyByResetWithTheEquipmentWell) {
  const auto inputs = all_inputs();
  for (const ModeState& s : all_states()) {
    if (s.mode != Mode::fault) continue;
    for (const ModeInputs& in : inputs) {
      const ModeState to = next_mode(s, in, kNow);
      if (to.mode == Mode::fault) {
        ASSERT_EQ(to.reason, s.reason);
        continue;
      }
      const bool reads =
          in.equipment != Equipment::silent && in.equipment != Equipment::implausible;
      ASSERT_TRUE(in.stop || (in.reset && reads));
    }
  }
}

TEST(Mode, AHandleToBeTurnedIsToldBeforeWhatWaitsForIt) {
  ModeInputs in{.equipment = Equipment::ok,
                .connected = true,
                .synced = true,
                .fresh = true,
                .partner = Partner::able,
                .dead_man = true};
  ModeState s{Mode::engaged, Reason::none, true};
  const auto expect = [&](Mode mode, Reason reason) {
    s = next_mode(s, in, kNow);
    EXPECT_EQ(s.mode, mode);
    EXPECT_EQ(s.reason, reason);
  };
  in.aligned = false;  // the clutch was let go
  expect(Mode::aligning, Reason::turn_handle);
  in.partner = Partner::not_ready;  // for the same reason
  expect(Mode::aligning, Reason::turn_handle);
  in.partner = Partner::fault;
  expect(Mode::aligning, Reason::partner_fault);
  in.partner = Partner::able, in.aligned = true;
  expect(Mode::aligning, Reason::dead_man_held);
  in.dead_man = false;
  expect(Mode::ready, Reason::none);
  in.aligned = false;
  expect(Mode::aligning, Reason::turn_handle);
}

TEST(Mode, WhatWasInterruptedWaitsForTheDeadManAndThenForTheHandle) {
  ModeState s{Mode::engaged, Reason::none, true};
  ModeInputs in{.equipment = Equipment::ok,
                .connected = true,
                .synced = true,
                .partner = Partner::able,
                .dead_man = true,
                .aligned = false};
  EXPECT_EQ((s = next_mode(s, in, kNow)).mode, Mode::holding);
  in.fresh = true;
  EXPECT_EQ((s = next_mode(s, in, kNow)).reason, Reason::dead_man_held);
  EXPECT_EQ(s.mode, Mode::holding);
  in.dead_man = false;
  EXPECT_EQ((s = next_mode(s, in, kNow)).mode, Mode::aligning);
  EXPECT_EQ(s.reason, Reason::turn_handle);
}

TEST(Mode, StartingUpIsNoFault) {
  ModeState s;
  for (int k = 0; k < 10000; ++k)
    s = next_mode(s,
                  {.equipment = Equipment::silent,
                   .connected = true,
                   .synced = true,
                   .fresh = true,
                   .partner = Partner::able},
                  kNow + milliseconds(k));
  EXPECT_EQ(s.mode, Mode::aligning);
  EXPECT_EQ(s.reason, Reason::silent);
}

TEST(Mode, AnOrientationNotYetKnownWaitsAndIsNoFault) {
  ModeState s;
  ModeInputs in{.equipment = Equipment::unoriented,
                .connected = true,
                .synced = true,
                .fresh = true,
                .partner = Partner::able};
  for (int k = 0; k < 1000; ++k) s = next_mode(s, in, kNow + milliseconds(k));
  EXPECT_EQ(s.mode, Mode::aligning);
  EXPECT_EQ(s.reason, Reason::no_attitude);
  in.equipment = Equipment::ok;
  EXPECT_EQ(next_mode(s, in, kNow + milliseconds(1000)).mode, Mode::ready);
}

TEST(Mode, EveryReasonHasItsSentence) {
  std::set<std::string> sentences;
  for (std::size_t r = 1; r < kReasons; ++r) {
    sentences.insert(to_string(static_cast<Reason>(r)));
    EXPECT_STRNE(to_string(static_cast<Reason>(r)), "");
  }
  EXPECT_EQ(sentences.size(), kReasons - 1);
}

}  // namespace
}  // namespace farhand
