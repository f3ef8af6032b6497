// Messages with random contents, for the tests of the wire.
#pragma once

#include "common/random.hpp"
#include "common/wire.hpp"

namespace farhand {

inline Vec3 random_vector(Random& random) {
  const double x = random.normal(), y = random.normal(), z = random.normal();
  return {x, y, z};
}

inline Quat random_rotation(Random& random) {
  const double w = random.normal(), x = random.normal(), y = random.normal(), z = random.normal();
  return Quat(w, x, y, z).normalized();
}

inline Twist random_twist(Random& random) {
  const Vec3 angular = random_vector(random), linear = random_vector(random);
  return {angular, linear};
}

inline bool random_bool(Random& random) {
  return random.uniform() < 0.5;
}

inline std::uint32_t random_count(Random& random) {
  return static_cast<std::uint32_t>(random.bits());
}

inline Mode random_mode(Random& random) {
  return static_cast<Mode>(random.bits() % kModes);
}
inline Reason random_reason(Random& random) {
  return static_cast<Reason>(random.bits() % kReasons);
}

inline LocalWall random_wall(Random& random) {
  LocalWall w{.known = random_bool(random), .sure = random_bool(random)};
  w.x_w = random_vector(random);
  w.n = random_vector(random).normalized();
  w.k = random.uniform(), w.b = random.uniform();
  w.contacts = random_count(random);
  w.net = random.normal();
  return w;
}

inline WaveSum random_wave(Random& random) {
  const Vec3 U = random_vector(random);
  return {U, random.uniform()};
}

inline void randomise(Random& random, MasterToSlave& m) {
  m.p_MH = random_vector(random);
  m.q_MH = random_rotation(random);
  m.V_MH = random_twist(random);
  m.mode = random_mode(random);
  m.reason = random_reason(random);
  m.dead_man = random_bool(random);
  m.clutch = random_bool(random);
  m.force_wanted = random_bool(random);
  m.dead_man_presses = random_count(random);
  m.clutch_presses = random_count(random);
  m.method = static_cast<Method>(random.bits() % kMethods);
  m.energies.translation = random.normal();
  m.energies.rotation = random.normal();
  m.has_felt = random_bool(random);
  m.F_felt_M = m.has_felt ? random_vector(random) : Vec3::Zero();
  m.has_wave = random_bool(random);
  m.wave = m.has_wave ? random_wave(random) : WaveSum{};
  m.has_user_wrench = random_bool(random);
  m.F_user_M = {};
  if (!m.has_user_wrench) return;
  m.F_user_M.force = random_vector(random);
  m.F_user_M.torque = random_vector(random);
}

inline void randomise(Random& random, SlaveToMaster& m) {
  m.p_SE = random_vector(random);
  m.q_SE = random_rotation(random);
  m.V_SE = random_twist(random);
  m.F_E_M.force = random_vector(random);
  m.F_E_M.torque = random_vector(random);
  m.mode = random_mode(random);
  m.reason = random_reason(random);
  m.coupled = random_bool(random);
  m.limits = random_count(random);
  m.dead_man_presses_seen = random_count(random);
  m.clutch_presses_seen = random_count(random);
  m.energies.translation = random.normal();
  m.energies.rotation = random.normal();
  m.has_robot = random_bool(random);
  m.p_MR = m.has_robot ? random_vector(random) : Vec3::Zero();
  m.q_MR = m.has_robot ? random_rotation(random) : Quat::Identity();
  m.V_MR = m.has_robot ? random_twist(random) : Twist{};
  m.has_wall = random_bool(random);
  m.wall = m.has_wall ? random_wall(random) : LocalWall{};
  m.has_wave = random_bool(random);
  m.wave = m.has_wave ? random_wave(random) : WaveSum{};
  m.has_acted = random_bool(random);
  m.acted = m.has_acted ? random.bits() % (kMaxStamp + 1) : 0;
}

// To the last bit.
inline bool same(const Twist& a, const Twist& b) {
  return a.angular == b.angular && a.linear == b.linear;
}
inline bool same(const LocalWall& a, const LocalWall& b) {
  return a.known == b.known && a.sure == b.sure && a.x_w == b.x_w && a.n == b.n && a.k == b.k &&
         a.b == b.b && a.contacts == b.contacts && a.net == b.net;
}
inline bool same(const WaveSum& a, const WaveSum& b) {
  return a.U == b.U && a.E == b.E;
}
inline bool same(const MasterToSlave& a, const MasterToSlave& b) {
  return a.p_MH == b.p_MH && a.q_MH.coeffs() == b.q_MH.coeffs() && same(a.V_MH, b.V_MH) &&
         a.mode == b.mode && a.reason == b.reason && a.dead_man == b.dead_man &&
         a.clutch == b.clutch && a.force_wanted == b.force_wanted &&
         a.dead_man_presses == b.dead_man_presses && a.clutch_presses == b.clutch_presses &&
         a.method == b.method && a.energies.translation == b.energies.translation &&
         a.energies.rotation == b.energies.rotation && a.has_user_wrench == b.has_user_wrench &&
         a.F_user_M.force == b.F_user_M.force && a.has_felt == b.has_felt &&
         a.F_felt_M == b.F_felt_M && a.F_user_M.torque == b.F_user_M.torque &&
         a.has_wave == b.has_wave && same(a.wave, b.wave);
}
inline bool same(const SlaveToMaster& a, const SlaveToMaster& b) {
  return a.p_SE == b.p_SE && a.q_SE.coeffs() == b.q_SE.coeffs() && same(a.V_SE, b.V_SE) &&
         a.F_E_M.force == b.F_E_M.force && a.F_E_M.torque == b.F_E_M.torque && a.mode == b.mode &&
         a.reason == b.reason && a.coupled == b.coupled && a.limits == b.limits &&
         a.dead_man_presses_seen == b.dead_man_presses_seen &&
         a.clutch_presses_seen == b.clutch_presses_seen &&
         a.energies.translation == b.energies.translation &&
         a.energies.rotation == b.energies.rotation && a.has_robot == b.has_robot &&
         a.p_MR == b.p_MR && a.q_MR.coeffs() == b.q_MR.coeffs() && same(a.V_MR, b.V_MR) &&
         a.has_wall == b.has_wall && same(a.wall, b.wall) && a.has_wave == b.has_wave &&
         same(a.wave, b.wave) && a.has_acted == b.has_acted && a.acted == b.acted;
}

}  // namespace farhand
