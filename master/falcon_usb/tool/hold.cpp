#include "master/falcon_usb/tool/hold.hpp"

#include <algorithm>

namespace farhand::falcon_usb {
namespace {

constexpr double kTs = 0.001, kVelocityHz = 60;

}  // namespace

Hold::Hold(const FalconGeometry& geometry)
    : handle_{.geometry = geometry}, velocity_(kVelocityHz, kTs) {}

void Hold::go(const Vec3& p_MH) {
  PositionControlConfig c{.max_force = kMaxForce,
                          .gravity_mass = weight_ / kGravity,
                          .safe = SafeMotion{.max_speed = kMaxSpeed}};
  c.pid.limit = kMaxForce;
  c.set_points = {{.p_MH = p_MH}};
  control_.emplace(c, kTs);
  lost_ = false;
}

void Hold::weigh() {
  weight_ = std::clamp(force_.dot(PositionControlConfig{}.up_M), 0.0, kMaxForce / 2);
}

std::optional<Hold::Step> Hold::step(TimePoint now, const HandleReading& reading) {
  if (!reading.ok) return {};
  handle_.update(reading.theta, pose_);
  if (pose_.status != Status::ok) return {};
  Step out{.p_MH = pose_.X_MH.p, .lost = lost_};
  const Twist& V = velocity_.step(pose_.X_MH);
  if (lost_ || !control_ || handle_.map_forces(pose_) != Status::ok) return out;
  LimitSet limits = kLimitNone;
  const Vec3 f = control_->step(now, {.p_MH = out.p_MH, .v_MH = V.linear}, limits);
  force_ = f;
  out.lost = lost_ = (out.p_MH - control_->target()).norm() > kLost;
  if (!lost_) out.tau = handle_.torque({.force = f});
  return out;
}

}  // namespace farhand::falcon_usb
