#include "master/device_feedforward.hpp"

namespace farhand {

DeviceFeedforward::DeviceFeedforward(const DeviceFeedforwardConfig& config,
                                     const DeviceModel& model) noexcept
    : friction_(model),
      damping_(config.damping *
               per_axis(model.translation.damping, model.tilt.damping, model.twist.damping)),
      inertia_(per_axis(config.inertia * model.translation.inertia,
                        config.rotation_inertia * model.tilt.inertia,
                        config.rotation_inertia * model.twist.inertia)),
      lift_M_(-config.gravity * model.weight_M),
      lead_(config.friction_lead) {
  for (DeviceGroup* g : {&friction_.translation, &friction_.tilt, &friction_.twist})
    g->damping = 0, g->friction *= config.friction;
}

DeviceAxes DeviceFeedforward::step(const DeviceMotion& motion) const noexcept {
  const DeviceAxes w = motion.v + lead_ * motion.a;
  DeviceAxes load = damping_ * motion.v + inertia_ * motion.a + drag(friction_, w) * w;
  load.segment<3>(0) += lift_M_.array();
  return load;
}

}  // namespace farhand
