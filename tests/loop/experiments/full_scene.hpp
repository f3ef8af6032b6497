// The full simulation's scene that the experiments on six axes vary, in parts as a scene says them.
#pragma once

#include <string>

#include "common/scene.hpp"

namespace farhand {

// The force loop that goes beyond the publications' (deploy/docs/force_control.md).
inline constexpr const char* kOurLoop = R"(
    closed_loop {
      filter: ERROR cutoff_hz: 8.5
      force { kp: 8.8 ki_per_s: 166 kd_s: 0 }
      torque { kp: 2 ki_per_s: 20 kd_s: 0.027 derivative_cutoff_hz: 30 }
      twist { kp: 1 ki_per_s: 10 kd_s: 0.0135 derivative_cutoff_hz: 30 }
    }
    device_model {} device_feedforward {} contact_damping {}
)";

// H1 on six axes: 50 mm up and down at 1 Hz, tilting and twisting all along.
inline constexpr const char* kH1Motion = R"(
  sine { from_s: 1 frequency_hz: 1 amplitude_m: [0, 0, 0.05] amplitude_deg: [6, 8, 12] })";

struct FullScene {
  std::string stages = "";  // of force_feedback
  std::string motion = "";  // of the hand
  std::string hand = "";    // of sim_hand
  std::string wall = "";    // of sim_arm
};

inline Scene parse(const FullScene& s) {
  const std::string text = "master { twin_delta {} force_sensing {} force_feedback {" + s.stages +
                           "} sim_hand {" + s.hand + " operator { motion {" + s.motion +
                           " max_speed_m_per_s: 0.6 } } } }\nslave { sim_arm {" + s.wall +
                           R"( force_sensor { force_noise_newton: 0 torque_noise_newton_meter: 0 } }
    workspace {} force_sensing {}
    joint_pid { gravity_compensation {} friction_compensation {} velocity_feedforward {} } }
link { to_slave { delay_ms: 2 } to_master { delay_ms: 2 } })";
  return parse_scene(text, "experiment");
}

}  // namespace farhand
