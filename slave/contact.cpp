#include "slave/contact.hpp"

#include <algorithm>
#include <cmath>
#include <limits>

namespace farhand {
namespace {

Proximity to(const Plane& s, const Vec3& p) {
  return {s.normal.dot(p - s.point), s.normal};
}

Proximity to(const Sphere& s, const Vec3& p) {
  const Vec3 r = p - s.centre;
  const double length = r.norm();
  return {length - s.radius, length > 0 ? Vec3(r / length) : Vec3::UnitZ()};
}

// The box is a smaller one, its core, with everything within edge_radius of it.
Proximity to(const Box& s, const Vec3& p) {
  const Vec3 p_B = s.X_SB.R.transpose() * (p - s.X_SB.p);
  const Vec3 beyond = p_B.cwiseAbs() - s.half_extents + Vec3::Constant(s.edge_radius);
  const Vec3 outside = beyond.cwiseMax(0);
  const double length = outside.norm();
  Vec3 normal_B = outside;
  double distance = length;
  if (length > 0) {
    normal_B /= length;
  } else {
    Eigen::Index face = 0;
    distance = beyond.maxCoeff(&face);
    normal_B = Vec3::Unit(face);
  }
  for (Eigen::Index i = 0; i < 3; ++i) normal_B[i] = std::copysign(normal_B[i], p_B[i]);
  return {distance - s.edge_radius, s.X_SB.R * normal_B};
}

// One touch: where, how deep, how hard.
struct Touch {
  Vec3 normal;
  Vec3 point;     // of the tool, deepest in the material
  Vec3 velocity;  // of that point
  double normal_force = 0;
};

Touch touch(const Surface& s, const Proximity& near, const Tip& tip) {
  const Vec3 lever = -tip.radius * near.normal;
  const Vec3 velocity = tip.V_E_S.linear + tip.V_E_S.angular.cross(lever);
  const double push =
      s.stiffness * (tip.radius - near.distance) - s.damping * near.normal.dot(velocity);
  return {near.normal, tip.X_SE.p + lever, velocity, std::max(0.0, push)};
}

Vec3 tangential(const Vec3& v, const Vec3& normal) {
  return v - normal.dot(v) * normal;
}

Vec3 capped(const Vec3& v, double limit) {
  const double length = v.norm();
  return length > limit ? Vec3(v * (limit / length)) : v;
}

Vec3 stretch(const ContactState::Anchor& a, const Touch& t, const Tip& tip) {
  if (!a.held) return Vec3::Zero();
  return tangential(tip.X_SE.p + tip.X_SE.R * a.p_E - a.p_S, t.normal);
}

}  // namespace

void move(Shape& shape, const Vec3& by) noexcept {
  if (auto* plane = std::get_if<Plane>(&shape)) plane->point += by;
  if (auto* sphere = std::get_if<Sphere>(&shape)) sphere->centre += by;
  if (auto* box = std::get_if<Box>(&shape)) box->X_SB.p += by;
}

Proximity proximity(const Shape& shape, const Vec3& p) noexcept {
  if (const auto* plane = std::get_if<Plane>(&shape)) return to(*plane, p);
  if (const auto* sphere = std::get_if<Sphere>(&shape)) return to(*sphere, p);
  return to(*std::get_if<Box>(&shape), p);
}

double penetration(const Surfaces& surfaces, const Vec3& p_SE, double tip_radius) noexcept {
  double deepest = -std::numeric_limits<double>::infinity();
  for (std::size_t i = 0; i < surfaces.count; ++i)
    deepest = std::max(deepest, tip_radius - proximity(surfaces.items[i].shape, p_SE).distance);
  return deepest;
}

Wrench contact_wrench(const Surfaces& surfaces, const ContactState& state,
                      const Tip& tip) noexcept {
  Wrench F;
  for (std::size_t i = 0; i < surfaces.count; ++i) {
    const Surface& s = surfaces.items[i];
    const Proximity near = proximity(s.shape, tip.X_SE.p);
    if (!(near.distance < tip.radius)) continue;
    const Touch t = touch(s, near, tip);
    Vec3 f = -t.normal_force * t.normal;
    if (s.friction > 0) {
      const Vec3 bristle = s.tangential_stiffness * stretch(state.anchors[i], t, tip) +
                           s.tangential_damping * tangential(t.velocity, t.normal);
      f += capped(bristle, s.friction * t.normal_force);
    }
    F.force += f;
    F.torque += (t.point - tip.X_SE.p).cross(f);
  }
  return F;
}

void update_anchors(const Surfaces& surfaces, ContactState& state, const Tip& tip) noexcept {
  for (std::size_t i = 0; i < surfaces.count; ++i) {
    const Surface& s = surfaces.items[i];
    ContactState::Anchor& a = state.anchors[i];
    const Proximity near = proximity(s.shape, tip.X_SE.p);
    if (!(near.distance < tip.radius)) {
      a.held = false;
      continue;
    }
    if (!(s.friction > 0)) continue;
    const Touch t = touch(s, near, tip);
    const Vec3 stretched = stretch(a, t, tip);
    const double longest = s.friction * t.normal_force / s.tangential_stiffness;
    if (a.held && stretched.norm() <= longest) continue;
    a = {.held = true,
         .p_S = t.point - capped(stretched, longest),
         .p_E = tip.X_SE.R.transpose() * (t.point - tip.X_SE.p)};
  }
}

}  // namespace farhand
