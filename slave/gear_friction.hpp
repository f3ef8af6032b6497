// Friction of the joints' gears: viscous, and Coulomb with stick. The Coulomb part is a bristle per
// joint, a spring of torque k (q - z) with damping d, both together at most the Coulomb torque; its
// foot z stays while the joint sticks (no creep) and is dragged along when it slides, once per
// integration step. Continuous in the state, so that an explicit integrator is at home with it.
#pragma once

#include <algorithm>

#include "slave/arm_dynamics.hpp"

namespace farhand {

// As arrays over the joints.
struct GearFriction {
  Vec6 coulomb = Vec6::Zero();    // [N m]
  Vec6 viscous = Vec6::Zero();    // [N m s]
  Vec6 stiffness = Vec6::Ones();  // k [N m/rad]
  Vec6 damping = Vec6::Zero();    // d [N m s]
};

// Bristles as stiff as a step of h [s] bears: k = J / h^2 and d = J / h, with J the joint's own
// inertia (armature and link about its axis). The mass matrix is never less than that of the
// armatures alone, so |eigenvalue| h <= 1 in every pose and with every load; RK4 is stable up to
// 2.6. At 1 kHz a joint gives by 1e-4 rad before it slides.
inline GearFriction make_gear_friction(const ArmModel& model, double h) noexcept {
  GearFriction g;
  for (Eigen::Index i = 0; i < 6; ++i) {
    const LinkModel& link = model.links[static_cast<std::size_t>(i)];
    const double inertia = model.armature + link.inertia.z();
    g.coulomb[i] = link.coulomb;
    g.viscous[i] = link.viscous;
    g.stiffness[i] = inertia / (h * h);
    g.damping[i] = inertia / h;
  }
  return g;
}

// Torque [N m] of the friction on the joints, with bristle feet z.
inline Vec6 friction_torque(const GearFriction& g, const Vec6& z, const Vec6& q,
                            const Vec6& dq) noexcept {
  Vec6 tau;
  for (Eigen::Index i = 0; i < 6; ++i) {
    const double limit = g.coulomb[i];
    const double spring = std::clamp(g.stiffness[i] * (q[i] - z[i]), -limit, limit);
    tau[i] = -g.viscous[i] * dq[i] - std::clamp(spring + g.damping[i] * dq[i], -limit, limit);
  }
  return tau;
}

inline void drag_feet(const GearFriction& g, const Vec6& q, Vec6& z) noexcept {
  for (Eigen::Index i = 0; i < 6; ++i) {
    const double longest = g.coulomb[i] / g.stiffness[i];
    z[i] = q[i] - std::clamp(q[i] - z[i], -longest, longest);
  }
}

}  // namespace farhand
