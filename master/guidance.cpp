#include "master/guidance.hpp"

#include <algorithm>

#include "common/limits.hpp"

namespace farhand {
namespace {

constexpr double kDampedFrom = 0.001;  // [m] depth at which a wall's damping is whole

// `normal` points to where the grip may be.
Vec3 wall(const Fixture& f, double depth, const Vec3& normal, const Vec3& v) noexcept {
  if (!(depth > 0)) return Vec3::Zero();
  const double damping = f.damping * std::min(1.0, depth / kDampedFrom);
  return std::max(0.0, f.stiffness * depth - damping * normal.dot(v)) * normal;
}

Vec3 pull(const Fixture& f, const Vec3& offset, const Vec3& v) noexcept {
  return -f.stiffness * offset - f.damping * v;
}

Vec3 force(const Fixture& f, const PlaneFixture& plane, const Vec3& p, const Vec3& v) noexcept {
  const Vec3& n = plane.normal_M;
  const double height = n.dot(p - plane.point_M);
  return plane.two_sided ? pull(f, height * n, n.dot(v) * n) : wall(f, -height, n, v);
}

Vec3 force(const Fixture& f, const AxisFixture& axis, const Vec3& p, const Vec3& v) noexcept {
  const Vec3& d = axis.direction_M;
  const Vec3 from = p - axis.point_M;
  return pull(f, from - d.dot(from) * d, v - d.dot(v) * d);
}

Vec3 force(const Fixture& f, const SphereFixture& sphere, const Vec3& p, const Vec3& v) noexcept {
  const Vec3 from = p - sphere.centre_M;
  const double distance = from.norm();
  const Vec3 out = distance > 0 ? Vec3(from / distance) : Vec3::UnitZ();
  switch (sphere.keep) {
    case SphereFixture::Keep::inside:
      return wall(f, distance - sphere.radius, -out, v);
    case SphereFixture::Keep::outside:
      return wall(f, sphere.radius - distance, out, v);
    case SphereFixture::Keep::attract:
      break;
  }
  const double share = 1 - distance * distance / (sphere.radius * sphere.radius);
  return share > 0 ? Vec3(share * pull(f, from, v)) : Vec3::Zero();
}

}  // namespace

Vec3 fixture_force(const Fixture& f, const Vec3& p_MH, const Vec3& v_MH) noexcept {
  const Vec3 wanted =
      std::visit([&](const auto& shape) { return force(f, shape, p_MH, v_MH); }, f.shape);
  return clamp_norm(wanted, f.max_force);
}

Wrench guide(const GuidanceConfig& config, const Handle& handle, const HandlePose& pose,
             const Twist& V_MH) noexcept {
  if (pose.status != Status::ok) return {};
  Vec3 f_M = Vec3::Zero();
  for (const Fixture& f : config.fixtures) f_M += fixture_force(f, pose.X_MH.p, V_MH.linear);
  Wrench F_G{.force = pose.R_MG.transpose() * f_M};
  if (config.handle_limits) F_G = F_G + edge_wrench(handle, *config.handle_limits);
  return F_G;
}

}  // namespace farhand
