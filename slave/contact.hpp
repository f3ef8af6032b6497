// The simulated world: surfaces, touched by the tool's tip, a sphere about E (radius 0: a
// point).
//
// Penalty contact at depth d: normal force max(0, k d + b d'). Coulomb friction with stick: a
// bristle between the point of the tool and the point of the surface that met, k_t per metre of
// stretch and b_t per m/s, together at most mu times the normal force; what exceeds it slides and
// drags the bristle's foot along. Holding below that limit does not creep.
//
// Forces are those the ROBOT exerts ON the environment; the arm feels their negative.
#pragma once

#include <array>
#include <cstddef>
#include <variant>

#include "common/geometry.hpp"

namespace farhand {

struct Plane {
  Vec3 point = Vec3::Zero();
  Vec3 normal = Vec3::UnitZ();  // unit, out of the material
};
struct Sphere {
  Vec3 centre = Vec3::Zero();
  double radius = 0.1;
};
// Edges and corners are rounded, so that the force turns steadily from face to face as long as the
// depth stays below edge_radius + tip radius; deeper, it jumps where two faces are equally near.
struct Box {
  Pose X_SB{};                              // B: centre and axes of the box
  Vec3 half_extents = Vec3(0.1, 0.1, 0.1);  // rounding included
  double edge_radius = 0.005;               // at most the smallest half extent
};
using Shape = std::variant<Plane, Sphere, Box>;

struct Surface {
  Shape shape{};
  double stiffness = 1000;             // k [N/m]
  double damping = 0;                  // b [N s/m]
  double friction = 0;                 // mu; 0: frictionless
  double tangential_stiffness = 1000;  // k_t [N/m], > 0
  double tangential_damping = 0;       // b_t [N s/m]
};

inline constexpr std::size_t kMaxSurfaces = 8;
struct Surfaces {
  std::array<Surface, kMaxSurfaces> items{};
  std::size_t count = 0;  // the first `count` items exist
};

// As if `shape` had been built further on by so much, S axes.
void move(Shape& shape, const Vec3& by) noexcept;

// Signed distance [m] of p to the shape (negative inside) and the outward unit normal there. At
// the centre of a sphere the normal is Z.
struct Proximity {
  double distance = 0;
  Vec3 normal = Vec3::UnitZ();
};
Proximity proximity(const Shape& shape, const Vec3& p) noexcept;

// The tool's tip: its frame and the velocity of E, S axes.
struct Tip {
  Pose X_SE{};
  Twist V_E_S{};
  double radius = 0;
};

// Where each bristle is rooted.
struct ContactState {
  struct Anchor {
    bool held = false;
    Vec3 p_S = Vec3::Zero();  // on the surface
    Vec3 p_E = Vec3::Zero();  // on the tool, E axes
  };
  std::array<Anchor, kMaxSurfaces> anchors{};
};

// Deepest penetration [m] of the tip into any surface; 0 or negative: no contact. With no surface,
// minus infinity.
double penetration(const Surfaces& surfaces, const Vec3& p_SE, double tip_radius) noexcept;

// Wrench of the robot on the environment at E, S axes. Leaves the anchors alone: it may be asked
// for at the inner stages of an integration step.
Wrench contact_wrench(const Surfaces& surfaces, const ContactState& state, const Tip& tip) noexcept;

// Once per integration step: sets anchors where contact begins, drags those that slide, drops those
// that have parted.
void update_anchors(const Surfaces& surfaces, ContactState& state, const Tip& tip) noexcept;

}  // namespace farhand
