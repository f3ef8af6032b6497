// The four states of either side, and the one function that moves between them.
//
//   idle     no partner, or the equipment is not fit: hand free, robot held
//   ready    partner there, dead-man released: hand free, robot held
//   engaged  dead-man held: the robot follows, the hand feels
//   holding  the link aged or the partner stopped while engaged: force fades, robot held, until the
//   dead-man is released
//
// Motion needs `engaged`; `engaged` is entered only from `ready`, and `ready` only with the
// dead-man seen released. So nothing resumes motion by itself: after any interruption the operator
// must press again.
#pragma once

#include <cstdint>

namespace farhand {

enum class Mode : std::uint8_t { idle, ready, engaged, holding };

struct ModeInputs {
  bool equipment_ok = false;  // device or robot reads, and its kinematics answer
  bool connected = false;     // the partner was heard within link.lost_ms
  bool fresh = false;         // its newest message came less than link.stale_ms ago
  bool partner_able = false;  // master: the slave is ready or engaged. Slave: always true
  bool dead_man = false;      // slave: the master says pressed and is itself engaged
};

constexpr Mode next_mode(Mode mode, const ModeInputs& in) noexcept {
  if (!in.equipment_ok || !in.connected) return Mode::idle;
  const bool good = in.fresh && in.partner_able;
  switch (mode) {
    case Mode::idle:
    case Mode::holding:
      return good && !in.dead_man ? Mode::ready : mode;
    case Mode::ready:
      if (!good) return Mode::idle;
      return in.dead_man ? Mode::engaged : Mode::ready;
    case Mode::engaged:
      if (!good) return Mode::holding;
      return in.dead_man ? Mode::engaged : Mode::ready;
  }
  return Mode::idle;
}

// The transitions that may ever be seen, staying included; the checkers of the loop and of the
// tests use this table.
constexpr bool is_legal(Mode from, Mode to) noexcept {
  constexpr bool kLegal[4][4] = {
      // to idle, ready, engaged, holding
      {true, true, false, false},  // from idle
      {true, true, true, false},   // from ready
      {true, true, true, true},    // from engaged
      {true, true, false, true},   // from holding
  };
  return kLegal[static_cast<int>(from)][static_cast<int>(to)];
}

constexpr const char* to_string(Mode mode) noexcept {
  constexpr const char* kNames[] = {"IDLE", "READY", "ENGAGED", "HOLDING"};
  return kNames[static_cast<int>(mode)];
}

}  // namespace farhand
