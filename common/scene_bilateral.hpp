// What a scene's bilateral architecture asks of either side.
#pragma once

#include "proto/scene.pb.h"

namespace farhand {

struct Channels {
  bool user_force = false;      // master to slave, beside the handle's position
  bool contact_force = true;    // slave to master, felt
  bool robot_position = false;  // slave to master, felt through a coupling
};

inline Channels channels(const proto::Scene& scene) {
  switch (scene.bilateral().architecture_case()) {
    case proto::Bilateral::kPositionPosition:
      return {.contact_force = false, .robot_position = true};
    case proto::Bilateral::kForcePosition:
      return {.user_force = true, .contact_force = false, .robot_position = true};
    case proto::Bilateral::kForceForce:
      return {.user_force = true, .robot_position = true};
    case proto::Bilateral::ARCHITECTURE_NOT_SET:
      break;
  }
  return {};
}

inline const proto::RobotCoupling& coupling(const proto::Bilateral& b) {
  if (b.has_position_position()) return b.position_position().coupling();
  return b.has_force_position() ? b.force_position().coupling() : b.force_force().coupling();
}

}  // namespace farhand
