#include "master/force_controller.hpp"

#include "master/force_law.hpp"

namespace farhand {

const Wrench& ForceController::step(const Wrench& F_env_G, const Wrench* F_user_G,
                                    LimitSet& set) noexcept {
  // Without gains the user's wrench drops out of the law: open loop.
  const Wrench F_user = F_user_G != nullptr ? *F_user_G : F_env_G;
  F_G_ = limit_wrench(config_.limits, motor_wrench({}, F_user, F_env_G), F_G_, set);
  return F_G_;
}

}  // namespace farhand
