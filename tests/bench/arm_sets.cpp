#include "tests/bench/arm_sets.hpp"

#include <numbers>

namespace farhand::bench {
namespace {

constexpr double kMargin = 0.06;  // [rad] to the joint limits
const ArmGeometry kArm;
const JointLimits kLimits;

bool within(const Vec6& q) {
  return ((q - kLimits.lower).array() > kMargin).all() &&
         ((kLimits.upper - q).array() > kMargin).all();
}

ArmTarget target(Draw& draw, const Vec6& q, double away) {
  Vec6 start;
  for (int i = 0; i < 6; ++i) start[i] = q[i] + draw(-away, away);
  return {rounded(quad_arm(kArm, q)), start};
}

using Singular = bool (*)(Vec6& q, double distance);

bool near_wrist(Vec6& q, double distance) {
  q[4] = std::copysign(distance, q[4]);
  return true;
}
bool near_elbow(Vec6& q, double distance) {
  q[2] = std::copysign(std::numbers::pi / 2, q[2]) - std::copysign(distance, q[3]);
  return true;
}
// a2 cos q2 + d4 sin(q2 + q3) = 0 puts the wrist centre on axis 1.
bool near_shoulder(Vec6& q, double distance) {
  const double sine = -kArm.a2 / kArm.d4 * std::cos(q[1]);
  if (std::abs(sine) > 0.95) return false;
  const double q23 = q[3] > 0 ? std::asin(sine) : std::numbers::pi - std::asin(sine);
  q[2] = std::remainder(q23 - q[1], 2 * std::numbers::pi);
  q[1] += std::copysign(distance, q[4]);
  return true;
}

// Both on one side of the shoulder's and of the elbow's singularity.
bool same_side(const Vec6& a, const Vec6& b) {
  const ArmKinematics x = kinematics(kArm, a), y = kinematics(kArm, b);
  return x.r * y.r > 0 && x.cos_q3 * y.cos_q3 > 0;
}

// Started on the same side of the singularity, or only across the shoulder's.
ArmSet singular(const std::string& name, Singular put, double distance, std::size_t n,
                bool across = false) {
  Draw draw;
  char text[40];
  std::snprintf(text, sizeof text, "%.0e rad %s the ", distance, across ? "across" : "from");
  ArmSet set{.name = text + name};
  while (set.targets.size() < n) {
    Vec6 q = draw.joints(kLimits);
    if (!put(q, distance) || !within(q)) continue;
    const ArmTarget t = target(draw, q, 0.01);
    if (same_side(q, t.start) != across) set.targets.push_back(t);
  }
  return set;
}

// Every reachable pose of the uniform set, its wrist centre moved outwards past the reach.
ArmSet unreachable(std::size_t n) {
  Draw draw;
  ArmSet set{.name = "out of reach", .reachable = false};
  while (set.targets.size() < n) {
    ArmTarget t = target(draw, draw.joints(kLimits), 0.05);
    const Vec3 wrist = t.X_SE.p - kArm.d6 * t.X_SE.R.col(2) - Vec3(0, 0, kArm.d1);
    const double beyond = std::pow(10, draw(-6, 0));
    t.X_SE.p += ((kArm.a2 + kArm.d4 + beyond) / wrist.norm() - 1) * wrist;
    set.targets.push_back(t);
  }
  return set;
}

ArmSet trajectory(const char* name, const Vec6& middle, const Vec6& amplitude, std::size_t n) {
  ArmSet set{.name = name, .trajectory = true};
  for (std::size_t i = 0; i < n; ++i) {
    Vec6 q;
    for (int j = 0; j < 6; ++j)
      q[j] = middle[j] + amplitude[j] * std::sin((2 + 0.3 * j) * 0.001 * double(i) + j);
    set.targets.push_back({rounded(quad_arm(kArm, q)), q});
  }
  return set;
}

}  // namespace

Vec6 Draw::joints(const JointLimits& limits) {
  Vec6 q;
  for (int i = 0; i < 6; ++i) q[i] = (*this)(limits.lower[i] + kMargin, limits.upper[i] - kMargin);
  return q;
}

std::vector<std::shared_ptr<const ArmSet>> arm_sets(std::size_t many, std::size_t few) {
  std::vector<std::shared_ptr<const ArmSet>> out;
  const auto add = [&](ArmSet set) { out.push_back(std::make_shared<ArmSet>(std::move(set))); };
  ArmSet uniform{.name = "uniform"};
  Draw draw;
  while (uniform.targets.size() < many)
    uniform.targets.push_back(target(draw, draw.joints(kLimits), 0.05));
  add(std::move(uniform));
  for (const double distance : {1e-3, 1e-6, 1e-9}) {
    add(singular("wrist", near_wrist, distance, few));
    add(singular("elbow", near_elbow, distance, few));
    add(singular("shoulder", near_shoulder, distance, few));
  }
  add(singular("shoulder", near_shoulder, 1e-3, few, true));
  add(unreachable(few));
  const Vec6 wide = Vec6::Constant(0.3);
  add(trajectory("1 kHz trajectory", kTeleopHome, wide, few));
  const Vec6 straight = (Vec6() << kTeleopHome.head<4>(), 0, kTeleopHome[5]).finished();
  add(trajectory("1 kHz trajectory through q5 = 0", straight, wide, few));
  return out;
}

}  // namespace farhand::bench
