// Model-mediated teleoperation (Mitra and Niemeyer 2008, IJRR 27, 253; Xu et al. 2016, IEEE Access
// 4, 425): what the slave found out about what it touches, a wall that the master renders without
// delay. Flat near the contact, with stiffness and damping along its normal n:
//
//   F = max(0, k (x - x_w) . n + b v . n) n
#pragma once

#include <cstdint>

#include "common/geometry.hpp"

namespace farhand {

// Normals with a larger cosine between them are of the same wall.
inline constexpr double kSameWall = 0.8;

// In the handle's terms, as sent. `k` is the wall in series with the robot's servo, for x the
// robot's target: what a handle without delay would feel.
struct LocalWall {
  bool known = false;
  bool sure = false;           // its stiffness was learnt from motion, and it stands still
  Vec3 x_w = Vec3::Zero();     // a point of its surface near the contact
  Vec3 n = Vec3::Zero();       // unit, into the wall; of use if known
  double k = 0, b = 0;         // [N/m], [N s/m]
  std::uint32_t contacts = 0;  // begun since the session began
  double net = 0;              // [J] that the wall gave since this contact began, < 0: took
};

}  // namespace farhand
