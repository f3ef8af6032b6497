// Handle pose to tool target, and the wrench back: reference section 8. Both directions live here,
// so the master never needs to know how the robot is placed.
//
// While coupled, with the references taken at the moment of coupling,
//   p_SE = p_SE0 + scale R_SM (p_MH - p_MH0),     R_SE = R_SM (R_MH R_MH0^T) R_SM^T R_SE0
// Uncoupled, the target stays. Coupling again stores new references, so the target never jumps.
//
// With `alignment` the first coupling says which orientation of the handle is the tool's, and the
// handle is turned back to about that before each later one. What is left of the angle stays as it
// is until the next: the tool does not turn for it, and it cannot add up, since it is measured from
// the first coupling. Once that is forgotten the next one counts as the first.
//
// Under rotation lock the tool keeps the orientation it was coupled with, and the torque is not
// sent back: what does no work on the robot does none on the hand.
#pragma once

#include <optional>

#include "common/geometry.hpp"
#include "common/limits.hpp"

namespace farhand {

// Axes of M seen from S: the user's forward, up and right are the robot's.
Mat3 twin_delta_axes() noexcept;  // Rz(-90 deg): forward is -X of the handle and +Y of the robot
Mat3 falcon_axes() noexcept;      // Rx(+90 deg): forward is -Z, up +Y

struct WorkspaceConfig {
  Mat3 R_SM = Mat3::Identity();
  double scale = 1;                 // motion; rotation is never scaled
  double force_scale = 1;           // of force and torque on the way back
  bool rotation_lock = false;       // the tool keeps its orientation
  std::optional<double> alignment;  // [rad] of the handle, within which it may be coupled again
  double position_step = 1e9;       // largest move of the target per tick [m]
  double rotation_step = 1e9;       // largest turn of the target per tick [rad]
};

struct WorkspaceState {
  bool coupled = false;
  // References, all that follow() needs of the moment of coupling.
  Vec3 p_MH0 = Vec3::Zero();
  Vec3 p_SE0 = Vec3::Zero();
  Mat3 R_HE = Mat3::Identity();    // the tool as if held by the handle: R_SE = R_SM R_MH R_HE
  std::optional<Mat3> R_HE_first;  // as at the first coupling; only with alignment
  Pose X_SE_target;
};

// Takes references: the handle at X_MH shall from now on mean X_SE (the pose the robot is commanded
// to).
void couple(const WorkspaceConfig& config, WorkspaceState& state, const Pose& X_MH,
            const Pose& X_SE) noexcept;
// The target stays where it is; X_SE is the pose the robot is commanded to, which becomes the
// target.
void uncouple(WorkspaceState& state, const Pose& X_SE) noexcept;

// The next coupling counts as the first.
void forget_orientation(WorkspaceState& state) noexcept;

// The orientation of the handle that is the target's, by the first coupling. Before it, while
// coupled and without alignment: none.
std::optional<Mat3> parallel_handle(const WorkspaceConfig& config,
                                    const WorkspaceState& state) noexcept;

// New target of this tick, moved towards the handle's by at most the configured steps (kLimitSpeed
// is set when they act). Uncoupled or with a non-finite pose (kLimitNotFinite): the old target.
const Pose& follow(const WorkspaceConfig& config, WorkspaceState& state, const Pose& X_MH,
                   LimitSet& set) noexcept;

// F_E_S, the wrench the robot exerts on the environment at E in axes of S, as the master gets it:
// scaled, in axes of M. Without its torque under rotation lock.
Wrench reflect(const WorkspaceConfig& config, const Wrench& F_E_S) noexcept;

// The other way: the user's wrench on the handle in axes of M as it acts at the robot, at E in axes
// of S, so that it and F_E_S balance where the hand feels what it gives. Zero with force_scale 0.
Wrench bring(const WorkspaceConfig& config, const Wrench& F_user_M) noexcept;

// The pose and velocity of the handle that mean this pose and velocity of the tool.
Pose as_handle(const WorkspaceConfig& config, const WorkspaceState& state,
               const Pose& X_SE) noexcept;
Twist as_handle(const WorkspaceConfig& config, const Twist& V_SE) noexcept;

}  // namespace farhand
