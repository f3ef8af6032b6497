#include "master/force_sensing.hpp"

namespace farhand {

const Wrench& HandleForceSensing::step(const EndForces& raw, const TwinDeltaJacobian& J) noexcept {
  if (J.status != Status::ok || !raw.f_E1_M.allFinite() || !raw.f_E2_A2.allFinite())
    return F_user_G_;
  F_user_G_ =
      wrench(J, EndForces{raw.f_E1_M - config_.bias.f_E1_M, raw.f_E2_A2 - config_.bias.f_E2_A2});
  F_user_G_.force -= J.R_MG.transpose() * (config_.grip_mass * config_.gravity_M);
  return F_user_G_;
}

}  // namespace farhand
