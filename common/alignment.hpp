// With the scene's alignment_deg the robot follows again only when the handle is turned as the
// robot is. Both sides judge by what the slave tells while uncoupled, each for itself.
#pragma once

#include "common/geometry.hpp"
#include "common/wire.hpp"

namespace farhand {

class Alignment {
 public:
  // Once within, it stays so up to this times the angle: the edge must not flicker.
  static constexpr double kRoom = 1.2;

  // within [rad] > 0
  explicit Alignment(double within) noexcept : within_(within) {}

  // Whether the handle at q_MH may be coupled. While it is, and before the first time, it may.
  bool step(const SlaveToMaster& told, const Quat& q_MH) noexcept {
    if (told.coupled || !told.has_robot) {
      if (!told.coupled) turn_.setZero();
      return aligned_ = true;
    }
    turn_ = rotation_vector((told.q_MR * q_MH.conjugate()).toRotationMatrix());
    return aligned_ = turn_.norm() <= (aligned_ ? kRoom * within_ : within_);
  }

  // By what the handle must be turned to be parallel to the robot: rotation vector, M axes [rad].
  // While coupled as it last was; zero before the first time.
  const Vec3& turn() const noexcept { return turn_; }

 private:
  double within_;
  bool aligned_ = false;
  Vec3 turn_ = Vec3::Zero();
};

}  // namespace farhand
