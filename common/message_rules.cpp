#include "common/message_rules.hpp"

#include <cmath>

namespace farhand {
namespace {

bool in_range(Mode m) noexcept {
  return m <= Mode::stopped;
}
bool in_range(Reason r) noexcept {
  return r <= Reason::no_attitude;
}
bool in_range(Method m) noexcept {
  return m <= Method::mmt;
}
bool is_rotation(const Quat& q) noexcept {
  return std::abs(q.norm() - 1) <= kQuaternionTolerance;  // false for NaN
}
bool finite(const Twist& V) noexcept {
  return V.angular.allFinite() && V.linear.allFinite();
}

bool finite(const Wrench& F) noexcept {
  return F.force.allFinite() && F.torque.allFinite();
}

bool valid(const LocalWall& w) noexcept {
  const bool real = w.x_w.allFinite() && w.n.allFinite() && std::isfinite(w.net) &&
                    std::isfinite(w.k) && std::isfinite(w.b) && w.k >= 0 && w.b >= 0;
  return real && (!w.known || std::abs(w.n.norm() - 1) <= kQuaternionTolerance);
}

bool valid(const WaveSum& s) noexcept {
  return s.U.allFinite() && std::isfinite(s.E) && s.E >= 0;
}

}  // namespace

bool valid(const Hello& h) noexcept {
  const bool whole = h.session != 0 && h.role <= Role::slave && h.lease <= Lease::lost;
  return whole && (h.role == Role::slave ? !h.take_over : h.lease == Lease::none && h.leases == 0);
}

bool valid(const MasterToSlave& m) noexcept {
  return m.p_MH.allFinite() && is_rotation(m.q_MH) && finite(m.V_MH) && in_range(m.mode) &&
         in_range(m.reason) && in_range(m.method) && std::isfinite(m.energies.translation) &&
         std::isfinite(m.energies.rotation) && finite(m.F_user_M) && m.F_felt_M.allFinite() &&
         valid(m.wave);
}

bool valid(const SlaveToMaster& m) noexcept {
  return m.p_SE.allFinite() && is_rotation(m.q_SE) && finite(m.V_SE) && finite(m.F_E_M) &&
         in_range(m.mode) && in_range(m.reason) && std::isfinite(m.energies.translation) &&
         std::isfinite(m.energies.rotation) && m.p_MR.allFinite() && is_rotation(m.q_MR) &&
         finite(m.V_MR) && (!m.has_wall || valid(m.wall)) && valid(m.wave) && m.acted <= kMaxStamp;
}

bool valid(const Header& h) noexcept {
  return h.session != 0 && h.sequence != 0 && h.sent <= kMaxStamp && h.echo_sent <= kMaxStamp &&
         h.echo_hold <= kMaxStamp;
}

}  // namespace farhand
