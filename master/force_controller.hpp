// From the environment's wrench to what the handle does to the hand. Open-loop reflection, tau_m =
// -J_h^-T F_e (twin-delta publication eq. 41 with K_h = 0, reference section 9.1); the user's
// wrench, where the handle senses it, is handed in already for the closed loop.
#pragma once

#include "common/limits.hpp"

namespace farhand {

struct ForceControllerConfig {
  WrenchLimits limits;
};

class ForceController {
 public:
  explicit ForceController(const ForceControllerConfig& config) noexcept : config_(config) {}

  // F_env_G: robot on environment, at H in handle axes; F_user_G: user on handle, or nullptr
  // without a force sensor. Returns the wrench of the handle on the hand, limited: at rest F_user =
  // F_env.
  const Wrench& step(const Wrench& F_env_G, const Wrench* F_user_G, LimitSet& set) noexcept;

  // The motors gave nothing of the last command: the next one starts from zero, within its slew.
  void let_go() noexcept { F_G_ = {}; }

 private:
  ForceControllerConfig config_;
  Wrench F_G_;  // last command
};

}  // namespace farhand
