// The model-mediated method at the handle in six axes (master/compensation/local_wall.hpp): of
// translation, the wall that the slave found, under the operator's tank; of rotation, P+d.
#pragma once

#include <optional>

#include "master/compensation/damped_rotation.hpp"
#include "master/compensation/inputs.hpp"
#include "master/compensation/local_wall.hpp"
#include "master/compensation/operator_tank.hpp"

namespace farhand {

struct MediatedCouplingConfig {
  WallRendererConfig renderer;
  OperatorTankConfig tank;
  double max_force = 20;                         // [N] that the hand may feel: the tank must see it
  std::optional<DampedRotationConfig> rotation;  // nothing: no torque
};

class MediatedCoupling {
 public:
  explicit MediatedCoupling(const MediatedCouplingConfig& config) noexcept;

  // Handle on coupling, G axes. A message without a wall is one of no wall.
  Wrench step(const CouplingInputs& in) noexcept;
  // The same for a caller who keeps the operator's tank: allowed is what the hand may be
  // given.
  Wrench render(const CouplingInputs& in, const OperatorAllowance& allowed) noexcept;
  // In a tick in which nothing of it is felt. The wall is forgotten: coupled again, the handle
  // means another place.
  void let_go() noexcept;
  // What the slave must know, into the next message.
  void tell(MasterToSlave& out) const noexcept;

 private:
  WallRenderer renderer_;
  OperatorTank tank_;
  double max_force_;
  double Ts_;
  FadeIn fade_in_;
  Vec3 F_M_ = Vec3::Zero();  // of the last tick
  std::optional<DampedRotation> rotation_;
};

}  // namespace farhand
