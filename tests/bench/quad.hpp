// The references that errors are measured against, in 113-bit arithmetic (__float128): the arm as
// the plain product of its DH matrices, and the handles' loop closures solved from a double answer.
// They share nothing with the product but its lengths.
#pragma once

#include <array>

#include "slave/arm.hpp"
#include "tests/bench/textbook.hpp"

namespace farhand::bench {

// Columns of `linear` and `angular` are joints.
struct QuadArm {
  std::array<Point<Quad>, 3> R;  // rows
  Point<Quad> p;
  std::array<Point<Quad>, 6> linear, angular;
};
QuadArm quad_arm(const ArmGeometry& geometry, const Vec6& q);
Pose rounded(const QuadArm& arm);

// Largest difference of an element of the rotation or of the position [m].
double pose_error(const QuadArm& arm, const Pose& X_SE);
double jacobian_error(const QuadArm& arm, const ArmJacobian& J);
// The tool of q against a pose: what an inverse has left.
double residual(const ArmGeometry& geometry, const Vec6& q, const Pose& X_SE);

// Largest error of a coordinate of the grip (twin delta: of either end) [m] for the motor angles.
// The exact place is that next to `near`.
double falcon_position_error(const FalconGeometry& g, const Vec3& theta1, const Vec3& p_MH,
                             const Vec3& near);
double twin_delta_position_error(const TwinDeltaGeometry& g, const Vec6& theta1,
                                 const TwinDeltaPose& pose, const TwinDeltaPose& near);

// Largest error of a motor angle [rad] at the pose. The exact angles are those next to `near`.
double falcon_angle_error(const FalconGeometry& g, const Vec3& p_MH, const Vec3& theta1,
                          const Vec3& near);
double twin_delta_angle_error(const TwinDeltaGeometry& g, const TwinDeltaPose& pose,
                              const Vec6& theta1, const Vec6& near);

}  // namespace farhand::bench
