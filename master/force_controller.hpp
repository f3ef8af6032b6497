// From the environment's wrench to what the handle does to the hand. The plain form is open-loop
// reflection, F_m = -F_e (twin-delta publication eq. 41 with K_h = 0, reference section 9.1). What
// a scene adds hides the device from the hand; in the order of a tick:
//
//   device observer     v, a of the handle and the load its model does not explain
//   contact damping     F_d = F_e + c v while something is touched, else F_d = F_e
//   closed loop         K (F_u - F_d)
//   feed-forward        the model's weight, damping, friction and inertia
//   disturbance         what the model does not explain, or the estimate of F_u
//
//   F_m = -F_e + share (K (F_u - F_d) - c v + feed-forward - disturbance)
//
// `share` moves between 0 and 1 within 0.1 s when the handle is engaged and its user felt, and
// back when not; on its way to 0 all but F_e stays as it last was. Then the limits act, and what
// they and the motors' limits took away stops the integrals. For 0.2 s after anything came or went
// (engagement, the environment, the user, the handle, the motors) the wrench changes at a share of
// its rate: a coupling must not jerk, while a contact may be as sudden as it is, and a closed loop
// held back by its rate would swing after a knock.
#pragma once

#include <array>
#include <optional>

#include "common/limits.hpp"
#include "master/contact_damping.hpp"
#include "master/device_feedforward.hpp"
#include "master/device_observer.hpp"
#include "master/disturbance_observer.hpp"
#include "master/force_loop.hpp"

namespace farhand {

struct DeviceConfig {
  DeviceModel model;
  DeviceObserverConfig observer;
  int motor_delay = 0;     // ticks from a command to its first push, 0 to kMaxMotorDelay
  bool feels_user = true;  // false: no force sensor, the user is part of what is not explained
};
inline constexpr int kMaxMotorDelay = 7;

struct ForceControllerConfig {
  WrenchLimits limits;
  double switching_share = 1;  // of the limits' steps, after something came or went; (0, 1]
  std::optional<ForceLoopConfig> closed_loop{};
  std::optional<DeviceConfig> device{};  // needed by all that follow
  std::optional<DeviceFeedforwardConfig> feedforward{};
  std::optional<ContactDampingConfig> contact_damping{};
  std::optional<DisturbanceObserverConfig> disturbance{};
};

struct ForceInputs {
  Wrench F_env_G;                      // robot on environment, at H in handle axes
  bool felt = true;                    // F_env_G is fresh: not faded, not uncoupled
  const Wrench* F_user_G = nullptr;    // user on handle; nullptr: not felt
  const HandlePose* handle = nullptr;  // measured now; nullptr: not measured
  Wrench F_given_G;                    // of the last command, what the motors' limits left
  bool engaged = false;                // more than the open loop is wanted
};

class ForceController {
 public:
  explicit ForceController(const ForceControllerConfig& config, double Ts) noexcept;

  // Returns the wrench of the handle on the hand, limited: at rest F_user = F_env. An environment's
  // wrench that is not finite, or larger than a million, counts as none; any other such input as
  // not there. The open loop looks at F_env_G alone.
  const Wrench& step(const ForceInputs& in, LimitSet& set) noexcept;

  // More than the open loop is built, so that the other inputs matter.
  bool closes() const noexcept { return closes_; }
  // The user's wrench as it was estimated without a sensor, or nullptr.
  const Wrench* user_estimate() const noexcept {
    return disturbance_ && !config_.device->feels_user ? &F_user_estimate_ : nullptr;
  }

  // The motors gave nothing of the last command: the next one starts from zero, within its slew.
  void let_go() noexcept { F_G_ = {}, switching_ = switching_ticks_; }

 private:
  const WrenchLimits& limits(const ForceInputs& in) noexcept;
  void observe(const HandlePose* handle, const Wrench* F_user_G, const Wrench& F_given_G) noexcept;
  Wrench beyond(const ForceInputs& in, const Wrench& F_env_G, LimitSet& set) noexcept;
  void unwind(const Wrench& F_given_G, LimitSet& set) noexcept;

  // What may come and go.
  struct There {
    bool engaged = false, felt = false, user = false, handle = false;
    bool operator==(const There&) const = default;
  };

  ForceControllerConfig config_;
  WrenchLimits switching_limits_;
  int switching_ticks_;
  There there_;
  int switching_ = 0;  // ticks left
  bool closes_;
  double share_step_;
  std::optional<ForceLoop> loop_;
  std::optional<DeviceObserver> observer_;
  std::optional<DeviceFeedforward> feedforward_;
  std::optional<ContactDamping> contact_damping_;
  std::optional<DisturbanceObserver> disturbance_;

  std::array<Wrench, kMaxMotorDelay + 1> given_{};  // the last commands, a ring
  std::size_t newest_ = 0;
  double share_ = 0;
  Wrench beyond_;  // of the last tick, whole
  Wrench wanted_;  // of the last tick, before the limits
  Wrench F_user_estimate_;
  Wrench F_G_;  // last command
};

}  // namespace farhand
