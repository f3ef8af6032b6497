// Where the robot can or shall not go, felt by the hand: joint limits, the edge of the reach, and
// the distance from each of the three singularities, every one with a margin of its own.
//
// The handle's wish is a tool pose beyond or within; the held pose is what the robot is told.
// Beyond an edge the held pose slides along it and a spring is stretched from it to the wish:
//   reach and elbow   the wrist centre stays in a shell about the shoulder (|cos q3| depends on its
//                     distance alone); the nearest point of the shell is held
//   shoulder          it stays outside a cylinder about axis 1, on the side it came from
//   joints, wrist     a joint stops at its limit, q5 at asin(margin) of the side it is on; the
//   others
//                     follow the wish
// The spring's wrench pulls across the edge only, so sliding along it costs nothing: for a joint it
// is J^-T tau with the torque that makes a point of the edge as stiff as configured. It is capped,
// and its change per tick too, so nothing jumps on entering, leaving, coupling or letting go.
//
// An edge never moves the robot by itself: an arm coupled beyond one has it where it stands, and
// can only come in.
#pragma once

#include "common/limits.hpp"
#include "slave/arm.hpp"

namespace farhand {

struct BoundaryConfig {
  double joint_margin = 0;        // [rad] inside every joint limit
  double reach_margin = 0;        // [m] inside the shell the wrist centre reaches
  double elbow_margin = 0;        // least |cos q3|, < 1
  double wrist_margin = 0;        // least |sin q5|, < 1; 0: q5 may pass through 0
  double shoulder_margin = 0;     // least |r| [m]; 0: the wrist centre may pass axis 1
  double stiffness = 400;         // [N/m] > 0
  double rotation_stiffness = 4;  // [N m/rad] > 0
  WrenchLimits limits{
      .force = 8, .torque = 0.4, .twist_torque = 0.4, .force_step = 0.5, .torque_step = 0.025};
};

struct BoundaryHold {
  Status status = Status::not_finite;  // not ok: no joint angles for this wish, the old ones stay
  bool held = false;                   // the wish is beyond an edge
  Vec6 q = Vec6::Zero();               // what the robot is told; speed limits come later
  Pose X_SE;                           // its pose
};

class Boundary {
 public:
  Boundary(const BoundaryConfig& config, const ArmGeometry& arm,
           const JointLimits& joints) noexcept;

  // Coupling: from here on wishes continue from the joint command q.
  void couple(const Vec6& q) noexcept;
  // Once per tick while coupled. `lag`: command less the q of the last step, of the joints for
  // which the wish shall continue from the command (of two shoulders or wrists, the nearer to it).
  BoundaryHold step(const Pose& X_wish, const Vec6& lag = Vec6::Zero()) noexcept;
  // Instead of step() while uncoupled: the spring lets go.
  void relax() noexcept;

  // Robot on environment as if the edge were one, at E, S axes: positive outwards.
  const Wrench& F_E_S() const noexcept { return F_E_S_; }

 private:
  void go_around(Eigen::Ref<Eigen::Vector2d> w) noexcept;
  Vec3 project(const Vec3& p_S_wrist) noexcept;
  ArmNearest beyond_limits(const Pose& X_SE, const Vec6& lag) const noexcept;
  Wrench joint_spring(const Vec6& q, const Vec6& beyond) const noexcept;
  void stretch(const Wrench& wanted) noexcept;

  BoundaryConfig config_;
  ArmGeometry arm_;
  JointLimits joints_;
  double reach_min_, reach_max_;  // of the configured margins

  // Since coupling:
  Vec6 lower_ = Vec6::Zero(), upper_ = Vec6::Zero();
  double inner_ = 0, outer_ = 0;                     // shell of the wrist centre [m]
  double post_ = 0;                                  // radius of the cylinder [m]
  Eigen::Vector2d side_ = Eigen::Vector2d::UnitX();  // where the wrist centre stands from axis 1
  bool sliding_ = false;                             // on the cylinder
  BoundaryHold last_;
  Vec6 q_wish_ = Vec6::Zero();  // of the wish, joint limits left out
  Wrench F_E_S_;
};

}  // namespace farhand
