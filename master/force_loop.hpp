// The closed force loop of the handle, F = K(F_u - F_d), on the six axes of G (twin-delta
// publication eq. 39-47 with its errata; reference sections 9.1, 9.4): one discrete PID per axis
// (common/pid.hpp) and one pole at fc before each, on the measured force as published, or on the
// error. The pole delays slow forces by 1 / (2 pi fc): 5.3 ms at 30 Hz, 19 ms at 8.5 Hz.
#pragma once

#include <array>

#include "common/geometry.hpp"
#include "common/pid.hpp"

namespace farhand {

struct ForceAxisConfig {
  PidConfig gains;        // [1], [1/s], [s]; its limit stays infinite: see unwind()
  double cutoff_hz = 30;  // 0: no pole
};

struct ForceLoopConfig {
  std::array<ForceAxisConfig, 6> axes{};  // force x y z, torque x y z
  bool filter_error = false;
};

class ForceLoop {
 public:
  ForceLoop(const ForceLoopConfig& config, double Ts) noexcept;

  // What the motors shall add to -F_d. F_user_G: user on handle; F_desired_G: what the user shall
  // feel. An axis whose input is not finite gives 0 and keeps its state.
  Wrench step(const Wrench& F_user_G, const Wrench& F_desired_G) noexcept;

  // Anti-windup by what acted: missing = the wrench asked for less the one given. On axes where
  // the last step's increment of the integral went the way of what is missing, it is taken back;
  // as the limits shorten the whole wrench, that may be every axis. True if any
  // was.
  bool unwind(const Wrench& missing) noexcept;

  // As new: the next step is the first, without a kick.
  void reset() noexcept;

 private:
  std::array<Pid, 6> pid_;
  std::array<double, 6> gain_;
  bool filter_error_;
  bool primed_ = false;
  std::array<double, 6> filtered_{};
  std::array<PidState, 6> state_{};
  std::array<double, 6> I_before_{};
};

}  // namespace farhand
