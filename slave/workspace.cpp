#include "slave/workspace.hpp"

namespace farhand {

Mat3 twin_delta_axes() noexcept {
  return (Mat3() << 0, 1, 0, -1, 0, 0, 0, 0, 1).finished();
}

Mat3 falcon_axes() noexcept {
  return (Mat3() << 1, 0, 0, 0, 0, -1, 0, 1, 0).finished();
}

void couple(const WorkspaceConfig& c, WorkspaceState& s, const Pose& X_MH,
            const Pose& X_SE) noexcept {
  s.coupled = true;
  s.p_MH0 = X_MH.p;
  s.p_SE0 = X_SE.p;
  s.X_SE_target = X_SE;
  s.R_HE.noalias() = (c.R_SM * X_MH.R).transpose() * X_SE.R;
  if (c.alignment && !s.R_HE_first) s.R_HE_first = s.R_HE;
}

void uncouple(WorkspaceState& s, const Pose& X_SE) noexcept {
  s.coupled = false;
  s.X_SE_target = X_SE;
}

void forget_orientation(WorkspaceState& s) noexcept {
  s.R_HE_first.reset();
}

std::optional<Mat3> parallel_handle(const WorkspaceConfig& c, const WorkspaceState& s) noexcept {
  if (s.coupled || !s.R_HE_first) return {};
  return c.R_SM.transpose() * s.X_SE_target.R * s.R_HE_first->transpose();
}

namespace {

// `to` turned back towards `from` so that they differ by at most `max` radians. Almost every tick
// passes the first test, a bound of 1 + 2 cos(max) from above; the angle itself is dear.
Mat3 limit_turn(const Mat3& from, const Mat3& to, double trace, double max,
                LimitSet& set) noexcept {
  const double max2 = max * max;
  if (max >= 3.15 || trace >= 3 - max2 + max2 * max2 / 12) return to;
  const Vec3 turn = rotation_vector(to * from.transpose());
  if (turn.norm() <= max) return to;
  set |= kLimitSpeed;
  return rotation(clamp_norm(turn, max)) * from;
}

}  // namespace

const Pose& follow(const WorkspaceConfig& c, WorkspaceState& s, const Pose& X_MH,
                   LimitSet& set) noexcept {
  if (!s.coupled) return s.X_SE_target;
  Pose& target = s.X_SE_target;
  const Vec3 wish = s.p_SE0 + c.scale * (c.R_SM * (X_MH.p - s.p_MH0));
  Mat3 R_wish = target.R;
  double trace = 3;  // of the turn still to make; not finite if R_wish is not
  if (!c.rotation_lock) {
    R_wish.noalias() = c.R_SM * (X_MH.R * s.R_HE).eval();
    trace = target.R.cwiseProduct(R_wish).sum();
  }
  if (!std::isfinite(wish.sum() + trace)) {
    set |= kLimitNotFinite;
    return target;
  }
  const Vec3 move = wish - target.p;
  const Vec3 allowed = clamp_norm(move, c.position_step);
  if (allowed != move) set |= kLimitSpeed;
  target.p = allowed == move ? wish : Vec3(target.p + allowed);
  if (!c.rotation_lock) target.R = limit_turn(target.R, R_wish, trace, c.rotation_step, set);
  return target;
}

Wrench reflect(const WorkspaceConfig& c, const Wrench& F_E_S) noexcept {
  Wrench F = c.force_scale * (c.R_SM.transpose() * F_E_S);
  if (c.rotation_lock) F.torque.setZero();
  return F;
}

Wrench bring(const WorkspaceConfig& c, const Wrench& F_user_M) noexcept {
  if (!(c.force_scale > 0)) return {};
  Wrench F = (1 / c.force_scale) * (c.R_SM * F_user_M);
  if (c.rotation_lock) F.torque.setZero();
  return F;
}

Pose as_handle(const WorkspaceConfig& c, const WorkspaceState& s, const Pose& X_SE) noexcept {
  return {c.R_SM.transpose() * X_SE.R * s.R_HE.transpose(),
          s.p_MH0 + (1 / c.scale) * (c.R_SM.transpose() * (X_SE.p - s.p_SE0))};
}

Twist as_handle(const WorkspaceConfig& c, const Twist& V_SE) noexcept {
  Twist V = c.R_SM.transpose() * V_SE;
  V.linear /= c.scale;
  return V;
}

}  // namespace farhand
