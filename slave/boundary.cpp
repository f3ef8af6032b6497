#include "slave/boundary.hpp"

#include <algorithm>
#include <cmath>
#include <limits>

namespace farhand {
namespace {

constexpr int kWrist = 4;            // index of joint 5
constexpr double kStraight = 0.2;    // tangent of what counts as straight beyond axis 1
constexpr double kRounding = 1e-12;  // [m] of a projection that keeps its point

Vec3 wrist_centre(const ArmGeometry& arm, const Pose& X_SE) noexcept {
  return X_SE.p - arm.d6 * X_SE.R.col(2);
}

JointLimits without_bounds(JointLimits joints) noexcept {
  constexpr double kNone = std::numeric_limits<double>::infinity();
  joints.lower.setConstant(-kNone);
  joints.upper.setConstant(kNone);
  return joints;
}

double time_of(const JointLimits& joints, const Vec6& move) noexcept {
  return move.cwiseAbs().cwiseQuotient(joints.speed).maxCoeff();
}

// Distance of the wrist centre from the shoulder at the elbow's sine of q3.
double reach_at(const ArmGeometry& arm, double sin_q3) noexcept {
  return std::sqrt(arm.a2 * arm.a2 + arm.d4 * arm.d4 + 2 * arm.a2 * arm.d4 * sin_q3);
}

}  // namespace

Boundary::Boundary(const BoundaryConfig& config, const ArmGeometry& arm,
                   const JointLimits& joints) noexcept
    : config_(config), arm_(arm), joints_(joints) {
  const double bent = std::sqrt(1 - config.elbow_margin * config.elbow_margin);
  reach_max_ = std::min(arm.a2 + arm.d4 - config.reach_margin, reach_at(arm, bent));
  reach_min_ = std::max(std::abs(arm.a2 - arm.d4) + config.reach_margin, reach_at(arm, -bent));
}

void Boundary::couple(const Vec6& q) noexcept {
  last_ = {.status = Status::ok, .q = q, .X_SE = forward(arm_, q)};
  q_wish_ = q;
  lower_ = joints_.lower.array() + config_.joint_margin;
  upper_ = joints_.upper.array() - config_.joint_margin;
  if (config_.wrist_margin > 0) {
    const double least = std::asin(config_.wrist_margin);
    if (q[kWrist] < 0)
      upper_[kWrist] = std::min(upper_[kWrist], -least);
    else
      lower_[kWrist] = std::max(lower_[kWrist], least);
  }
  lower_ = lower_.cwiseMin(q);
  upper_ = upper_.cwiseMax(q);

  const Vec3 w = wrist_centre(arm_, last_.X_SE);
  const double reach = (w - Vec3(0, 0, arm_.d1)).norm(), r = w.head<2>().norm();
  inner_ = std::min(reach_min_, reach);
  outer_ = std::max(reach_max_, reach);
  post_ = std::min(config_.shoulder_margin, r);
  sliding_ = false;
  if (r > 0) side_ = w.head<2>() / r;
}

// Off the cylinder, towards the plane that touches it where the wrist centre stood last: it slides
// around as long as the wish lies behind that plane, and never jumps through. Of a wish straight
// beyond axis 1 no side is the nearer: there it stays.
void Boundary::go_around(Eigen::Ref<Eigen::Vector2d> w) noexcept {
  const double before = side_.dot(w);
  sliding_ = w.norm() < post_ || (sliding_ && before < post_);
  if (!sliding_) return;
  const Eigen::Vector2d aside = w - before * side_;
  if (aside.norm() < -kStraight * before)
    w = post_ * side_;
  else
    w = post_ * (post_ * side_ + aside).normalized();
}

// The nearest point of the shell that is outside the cylinder.
Vec3 Boundary::project(const Vec3& p_S_wrist) noexcept {
  Vec3 w = p_S_wrist - Vec3(0, 0, arm_.d1);
  if (post_ > 0) go_around(w.head<2>());
  const double reach = w.norm(), r = w.head<2>().norm();
  if (r > 0) side_ = w.head<2>() / r;
  const double nearest = std::clamp(reach, inner_, outer_);
  if (nearest != reach && reach > 0) w *= nearest / reach;
  return w + Vec3(0, 0, arm_.d1);
}

// The wish goes on beyond the limits, and a joint is held at its own. But close by a singularity
// the wish may turn past a limit faster than the command follows; where then the other shoulder or
// wrist is within them and much sooner reached, it is right.
ArmNearest Boundary::beyond_limits(const Pose& X_SE, const Vec6& lag) const noexcept {
  const ArmNearest on = inverse(arm_, without_bounds(joints_), X_SE, q_wish_ + lag);
  if (on.status != Status::ok || config_.wrist_margin > 0) return on;
  const Vec6 q_cmd = last_.q + lag;
  const ArmNearest other = inverse(arm_, joints_, X_SE, q_cmd);
  const bool differs =
      other.branch.wrist != on.branch.wrist || other.branch.shoulder != on.branch.shoulder;
  const bool sooner = 2 * time_of(joints_, other.q - q_cmd) < time_of(joints_, on.q - q_cmd);
  return other.status == Status::ok && differs && sooner ? other : on;
}

BoundaryHold Boundary::step(const Pose& X_wish, const Vec6& lag) noexcept {
  const Vec3 wish = wrist_centre(arm_, X_wish), kept = project(wish);
  BoundaryHold now{.held = (kept - wish).squaredNorm() > kRounding * kRounding, .X_SE = X_wish};
  if (now.held) now.X_SE.p += kept - wish;
  ArmNearest nearest = inverse(arm_, joints_, now.X_SE, q_wish_ + lag);
  if (nearest.status == Status::out_of_limits) nearest = beyond_limits(now.X_SE, lag);
  now.status = nearest.status;
  if (now.status != Status::ok) {
    stretch({});
    now.held = true, now.q = last_.q, now.X_SE = last_.X_SE;
    return now;
  }
  q_wish_ = nearest.q;
  now.q = q_wish_.cwiseMax(lower_).cwiseMin(upper_);
  Wrench F{.force = now.held ? Vec3(config_.stiffness * (wish - kept)) : Vec3::Zero()};
  if (now.q != q_wish_) {
    now.held = true;
    now.X_SE = forward(arm_, now.q);
    F = F + joint_spring(now.q, q_wish_ - now.q);
  }
  stretch(F);
  last_ = now;
  return now;
}

// Row i of J^-1, n, is the wrench that joint i alone feels, as one newton metre. The nearest pose
// with joint i at its limit is a step of beyond_i / (n K^-1 n) along K^-1 n from the wish.
Wrench Boundary::joint_spring(const Vec6& q, const Vec6& beyond) const noexcept {
  const ArmKinematics at = kinematics(arm_, q);
  Mat6 rows;  // of the inverse Jacobian; columns force, then torque
  for (int k = 0; k < 6; ++k) {
    Twist unit;
    (k < 3 ? unit.linear : unit.angular)[k % 3] = 1;
    rows.col(k) = joint_rates(arm_, at, unit).dq;
  }
  Wrench F;
  for (int i = 0; i < 6; ++i) {
    if (beyond[i] == 0) continue;
    const Vec3 n_f = rows.block<1, 3>(i, 0), n_m = rows.block<1, 3>(i, 3);
    const double softness =
        n_f.squaredNorm() / config_.stiffness + n_m.squaredNorm() / config_.rotation_stiffness;
    if (softness > 0) F = F + (beyond[i] / softness) * Wrench{n_f, n_m};
  }
  return F;
}

void Boundary::relax() noexcept {
  stretch({});
}

void Boundary::stretch(const Wrench& wanted) noexcept {
  LimitSet set = kLimitNone;  // a capped spring is no event
  F_E_S_ = limit_wrench(config_.limits, wanted, F_E_S_, set);
}

}  // namespace farhand
