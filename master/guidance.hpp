// What the master itself makes the hand feel, on top of what the robot touches: virtual fixtures at
// the grip (a plane, a line, a sphere), and the end of the handle's own accepted workspace. All are
// springs without memory. Their wrench is added to the environment's before the force controller,
// so every cap and every slew limit of the hand's force acts on them too.
//
// A wall pushes f = max(0, k depth - b' v) along its normal, never pulls, and its damping b' grows
// with the first millimetre of depth, so that touching it fast makes no jump. What is two-sided
// (a plane, a line, an attracting sphere) pulls f = -k offset - b v across itself. Either is
// capped.
#pragma once

#include <optional>
#include <variant>
#include <vector>

#include "master/handle.hpp"

namespace farhand {

// One-sided: the grip is kept on the side the normal points to. Two-sided: in the plane.
struct PlaneFixture {
  Vec3 point_M = Vec3::Zero();
  Vec3 normal_M = Vec3::UnitZ();  // unit
  bool two_sided = false;
};
// The grip is held on the line.
struct AxisFixture {
  Vec3 point_M = Vec3::Zero();
  Vec3 direction_M = Vec3::UnitZ();  // unit
};
// attract: to the centre from wherever the grip is inside; the pull ends at the surface, as
// (1 - (distance / radius)^2) of the spring and of the damper.
struct SphereFixture {
  enum class Keep { inside, outside, attract };
  Vec3 centre_M = Vec3::Zero();
  double radius = 0.02;  // [m] > 0
  Keep keep = Keep::inside;
};

struct Fixture {
  std::variant<PlaneFixture, AxisFixture, SphereFixture> shape{};
  double stiffness = 300;  // [N/m]
  double damping = 3;      // [N s/m]
  double max_force = 8;    // [N]
};

struct GuidanceConfig {
  std::vector<Fixture> fixtures{};
  std::optional<WorkspaceEdge> handle_limits{};
};

// Force of one fixture on the hand [N], M axes, from position and velocity of the grip.
Vec3 fixture_force(const Fixture& fixture, const Vec3& p_MH, const Vec3& v_MH) noexcept;

// Wrench of all of it on the hand, at H, handle axes; the handle as map_forces() left it. Zero
// unless the pose is ok.
Wrench guide(const GuidanceConfig& config, const Handle& handle, const HandlePose& pose,
             const Twist& V_MH) noexcept;

}  // namespace farhand
