// What a simulated device knows and no controller sees.
#pragma once

#include <optional>

#include "master/devices.hpp"
#include "master/master.hpp"
#include "slave/slave.hpp"

namespace farhand {

// As the device knows it, or else as it was measured.
inline Vec3 true_handle(const AnyDevice& device, const Vec3& measured) {
  return std::visit(
      [&](const auto& d) -> Vec3 {
        if constexpr (requires { d.truth(); })
          return d.truth().state.p_MH;
        else
          return measured;
      },
      device);
}

// What the user truly exerts on the handle, in handle axes; nothing of a device that does not know.
inline std::optional<Wrench> true_user(const AnyDevice& device, const Mat3& R_MG) {
  return std::visit(
      [&](const auto& d) -> std::optional<Wrench> {
        if constexpr (requires { d.truth(); }) {
          const HandLoad& user = d.truth().user;
          Wrench F = R_MG.transpose() * Wrench{user.force, user.moment};
          F.torque.z() += user.twist;
          return F;
        }
        return {};
      },
      device);
}

// What a twin delta's motors do to the hand, in handle axes.
inline Wrench motor_wrench(const MasterTick& t) {
  const TwinDeltaForward at = forward(kTwinDelta, t.reading.theta);
  return wrench(jacobian(kTwinDelta, at, t.handle.R_MG), t.tau);
}

// Where the handle's true position asks the tool to be, by the references the slave took.
inline Vec3 wanted_tool(const Slave& slave, const Vec3& p_MH) {
  const WorkspaceState& w = slave.workspace();
  const WorkspaceConfig& c = slave.config().workspace;
  return w.p_SE0 + c.scale * (c.R_SM * (p_MH - w.p_MH0));
}

}  // namespace farhand
