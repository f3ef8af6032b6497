// The safety states of either side, and the one function that moves between them.
//
//   DISCONNECTED  no partner: hand free, robot held
//   SYNCING       the partner is heard, its clock or a fresh message is still missing
//   ALIGNING      something must be done first, and `reason` says what
//   READY         dead-man released, everything in order
//   ENGAGED       dead-man held: the robot follows, the hand feels
//   HOLDING       interrupted while engaged: robot held, force fades, until the dead-man is
//                 released
//   FAULT         device or robot failed for kFaultAfter; latched until it is well and reset is
//                 asked for
//   STOPPED       told to stop; final
//
// What is graver wins: STOPPED, FAULT, DISCONNECTED, then HOLDING against ENGAGED, then SYNCING,
// ALIGNING, READY. Motion needs ENGAGED, which is entered only from READY, and READY only with the
// dead-man seen released. So nothing resumes motion by itself: after any interruption the operator
// must press again. What hand and robot do in each state: deploy/docs/states.md.
#pragma once

#include <cstddef>
#include <cstdint>

#include "common/time.hpp"

namespace farhand {

// The numbers are those of the wire and of recordings.
enum class Mode : std::uint8_t {
  disconnected,
  ready,
  engaged,
  holding,
  syncing,
  aligning,
  fault,
  stopped
};
inline constexpr std::size_t kModes = 8;

// Why a side is where it is; `none` when READY or ENGAGED. Also told to the partner.
enum class Reason : std::uint8_t {
  none,
  no_partner,
  no_clock,
  link_old,
  partner_not_ready,
  partner_fault,
  partner_stopped,
  silent,
  implausible,
  outside,
  dead_man_held,
  turn_handle,
  stop_asked,
  no_attitude
};
inline constexpr std::size_t kReasons = 14;

// Of the device or the robot: reads, and its kinematics answer; has no answer where it stands
// (never a fault: it is moved back); does not read; reads what cannot be; how it is turned is not
// known yet (never a fault: its AHRS is starting).
enum class Equipment : std::uint8_t { ok, outside, silent, implausible, unoriented };

// As its newest message says.
enum class Partner : std::uint8_t { able, not_ready, fault, stopped };

constexpr Partner partner(Mode told) noexcept {
  switch (told) {
    case Mode::ready:
    case Mode::engaged:
      return Partner::able;
    case Mode::fault:
      return Partner::fault;
    case Mode::stopped:
      return Partner::stopped;
    default:
      return Partner::not_ready;
  }
}

struct ModeInputs {
  Equipment equipment = Equipment::silent;
  bool connected = false;                // the partner was heard within link.lost_ms
  bool synced = false;                   // its clock is known
  bool fresh = false;                    // its newest message came less than link.stale_ms ago
  Partner partner = Partner::not_ready;  // slave: always able, as it is the master that decides
  bool dead_man = false;                 // slave: the master says pressed and is itself engaged
  bool aligned = true;  // the handle may be coupled as it is turned, or need not now
  bool reset = false;   // the operator has seen the fault: clutch, dead-man released
  bool stop = false;
};

// How long device or robot may fail before that is a fault. Motion stops at the first failure.
inline constexpr Duration kFaultAfter = std::chrono::milliseconds(50);

struct ModeState {
  Mode mode = Mode::disconnected;
  Reason reason = Reason::no_partner;
  bool was_fit = false;  // the equipment has been in order: until then it is only starting up
  bool failing = false;
  TimePoint failing_since{};
};

namespace detail {

constexpr bool fails(Equipment e) noexcept {
  return e == Equipment::silent || e == Equipment::implausible;
}

constexpr Reason reason(Equipment e) noexcept {
  if (e == Equipment::outside) return Reason::outside;
  if (e == Equipment::unoriented) return Reason::no_attitude;
  return e == Equipment::implausible ? Reason::implausible : Reason::silent;
}

constexpr Reason reason(Partner p) noexcept {
  if (p == Partner::fault) return Reason::partner_fault;
  return p == Partner::stopped ? Reason::partner_stopped : Reason::partner_not_ready;
}

// What keeps the robot from following, gravest first; none if nothing.
constexpr Reason obstacle(const ModeInputs& in) noexcept {
  if (in.equipment != Equipment::ok) return reason(in.equipment);
  if (!in.fresh) return Reason::link_old;
  if (in.partner != Partner::able) return reason(in.partner);
  return Reason::none;
}

// A partner that is not ready may wait for just that, so it is told first.
constexpr bool must_turn(const ModeInputs& in, Reason obstacle) noexcept {
  return !in.aligned && (obstacle == Reason::none || obstacle == Reason::partner_not_ready);
}

constexpr void change(ModeState& s, Mode mode, Reason why = Reason::none) noexcept {
  s.mode = mode;
  s.reason = why;
}

// In order while not moving: what is still missing.
constexpr void prepare(ModeState& s, const ModeInputs& in) noexcept {
  if (!in.synced) return change(s, Mode::syncing, Reason::no_clock);
  if (!in.fresh) return change(s, Mode::syncing, Reason::link_old);
  const Reason why = obstacle(in);
  if (must_turn(in, why)) return change(s, Mode::aligning, Reason::turn_handle);
  if (why != Reason::none) return change(s, Mode::aligning, why);
  const bool was_ready = s.mode == Mode::ready;
  if (in.dead_man && !was_ready) return change(s, Mode::aligning, Reason::dead_man_held);
  change(s, in.dead_man ? Mode::engaged : Mode::ready);
}

// Engaged or holding.
constexpr void go_on(ModeState& s, const ModeInputs& in) noexcept {
  const Reason why = obstacle(in);
  const bool interrupted = s.mode == Mode::holding;
  if (must_turn(in, why) && !(interrupted && in.dead_man))
    return change(s, Mode::aligning, Reason::turn_handle);
  if (!interrupted) {
    if (why != Reason::none) return change(s, Mode::holding, why);
    return change(s, in.dead_man ? Mode::engaged : Mode::ready);
  }
  if (why == Reason::none && !in.dead_man) return change(s, Mode::ready);
  s.reason = why == Reason::none ? Reason::dead_man_held : why;
}

}  // namespace detail

// One tick. The first inputs may be anything.
constexpr ModeState next_mode(ModeState s, const ModeInputs& in, TimePoint now) noexcept {
  const bool fails = detail::fails(in.equipment);
  if (fails && !s.failing) s.failing_since = now;
  s.failing = fails;
  s.was_fit = s.was_fit || !fails;

  if (in.stop || s.mode == Mode::stopped) {
    detail::change(s, Mode::stopped, Reason::stop_asked);
  } else if (s.mode == Mode::fault && (fails || !in.reset)) {
    return s;
  } else if (fails && s.was_fit && now - s.failing_since >= kFaultAfter) {
    detail::change(s, Mode::fault, detail::reason(in.equipment));
  } else if (!in.connected) {
    detail::change(s, Mode::disconnected, Reason::no_partner);
  } else if (s.mode == Mode::engaged || s.mode == Mode::holding) {
    detail::go_on(s, in);
  } else {
    detail::prepare(s, in);
  }
  return s;
}

// The transitions that may ever be seen, staying included (a failure is a fault only later, so
// never straight from READY or ENGAGED); the checkers of the loop and of the tests use this table.
constexpr bool is_legal(Mode from, Mode to) noexcept {
  constexpr bool kLegal[kModes][kModes] = {
      // to disconnected, ready, engaged, holding, syncing, aligning, fault, stopped
      {true, true, false, false, true, true, true, true},       // from disconnected
      {true, true, true, false, true, true, false, true},       // from ready
      {true, true, true, true, false, true, false, true},       // from engaged
      {true, true, false, true, false, true, true, true},       // from holding
      {true, true, false, false, true, true, true, true},       // from syncing
      {true, true, false, false, true, true, true, true},       // from aligning
      {true, true, false, false, true, true, true, true},       // from fault
      {false, false, false, false, false, false, false, true},  // from stopped
  };
  return kLegal[static_cast<int>(from)][static_cast<int>(to)];
}

constexpr const char* to_string(Mode mode) noexcept {
  constexpr const char* kNames[kModes] = {"DISCONNECTED", "READY",    "ENGAGED", "HOLDING",
                                          "SYNCING",      "ALIGNING", "FAULT",   "STOPPED"};
  return kNames[static_cast<int>(mode)];
}

// For the operator: what is the matter and what to do about it. Empty for none.
constexpr const char* to_string(Reason reason) noexcept {
  constexpr const char* kSentences[kReasons] = {
      "",
      "nothing is heard from the other side: start it, or check the network",
      "measuring the way to the other side",
      "no fresh message from the other side: the network is late or cut",
      "the other side is not ready: see what it says",
      "the other side has a fault: see what it says",
      "the other side was stopped: start it again",
      "it does not answer: check power and cable, then press the clutch, dead-man released",
      "its readings cannot be: check encoders and cable, then press the clutch, dead-man released",
      "outside of its workspace: move it back",
      "release the dead-man",
      "turn the handle to the robot's orientation",
      "stopped",
      ("waiting a second for the attitude sensor on the grip; if it lasts, check its cable and "
       "settings")};
  return kSentences[static_cast<int>(reason)];
}

}  // namespace farhand
