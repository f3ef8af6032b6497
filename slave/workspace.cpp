#include "slave/workspace.hpp"

namespace farhand {

Mat3 twin_delta_axes() noexcept {
  return (Mat3() << 0, 1, 0, -1, 0, 0, 0, 0, 1).finished();
}

Mat3 falcon_axes() noexcept {
  return (Mat3() << 1, 0, 0, 0, 0, -1, 0, 1, 0).finished();
}

void couple(WorkspaceState& s, const Pose& X_MH, const Pose& X_SE) noexcept {
  s = {.coupled = true, .p_MH0 = X_MH.p, .R_MH0 = X_MH.R, .X_SE0 = X_SE, .X_SE_target = X_SE};
}

void uncouple(WorkspaceState& s, const Pose& X_SE) noexcept {
  s.coupled = false;
  s.X_SE_target = X_SE;
}

namespace {

// `to` turned back towards `from` so that they differ by at most `max` radians. The cosine test
// comes first: almost every tick passes it, and the angle itself is dear.
Mat3 limit_turn(const Mat3& from, const Mat3& to, double max, LimitSet& set) noexcept {
  const double trace = from.cwiseProduct(to).sum();
  if (max >= 3.15 || trace >= 1 + 2 * std::cos(max)) return to;
  const Vec3 turn = rotation_vector(to * from.transpose());
  if (turn.norm() <= max) return to;
  set |= kLimitSpeed;
  return rotation(clamp_norm(turn, max)) * from;
}

}  // namespace

const Pose& follow(const WorkspaceConfig& c, WorkspaceState& s, const Pose& X_MH,
                   LimitSet& set) noexcept {
  if (!s.coupled) return s.X_SE_target;
  const Vec3 wish = s.X_SE0.p + c.scale * (c.R_SM * (X_MH.p - s.p_MH0));
  const Mat3 R_wish = c.R_SM * (X_MH.R * s.R_MH0.transpose()) * c.R_SM.transpose() * s.X_SE0.R;
  if (!is_finite(wish) || !is_finite(R_wish)) {
    set |= kLimitNotFinite;
    return s.X_SE_target;
  }
  const Vec3 move = wish - s.X_SE_target.p;
  const Vec3 allowed = clamp_norm(move, c.position_step);
  if (allowed != move) set |= kLimitSpeed;
  s.X_SE_target.p = allowed == move ? wish : Vec3(s.X_SE_target.p + allowed);
  s.X_SE_target.R = limit_turn(s.X_SE_target.R, R_wish, c.rotation_step, set);
  return s.X_SE_target;
}

Wrench reflect(const WorkspaceConfig& c, const Wrench& F_E_S) noexcept {
  return c.force_scale * (c.R_SM.transpose() * F_E_S);
}

}  // namespace farhand
