// The force loop that goes beyond the publications', as a scene says it
// (deploy/docs/force_control.md).
#pragma once

namespace farhand {

inline constexpr const char* kOurLoop = R"(
    closed_loop {
      filter: ERROR cutoff_hz: 8.5
      force { kp: 8.8 ki_per_s: 166 kd_s: 0 }
      torque { kp: 2 ki_per_s: 20 kd_s: 0.027 derivative_cutoff_hz: 30 }
      twist { kp: 1 ki_per_s: 10 kd_s: 0.0135 derivative_cutoff_hz: 30 }
    }
    device_model {} device_feedforward {} contact_damping {}
)";

}  // namespace farhand
