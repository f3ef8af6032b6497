// Broken scenes about a Falcon's AHRS, and about turning a grip that has none.
#pragma once

#include "tests/common/broken_scene.hpp"

namespace farhand {

inline std::vector<BrokenScene> broken_ahrs_scenes() {
  const auto with = [](const std::string& master, const std::string& workspace = "") {
    return "slave { sim_arm {} joint_pid {} workspace {" + workspace + "} }\nmaster { " + master +
           " }";
  };
  const auto with_ahrs = [&](const std::string& inside) {
    return with("falcon {} sim_hand {}\n ahrs { " + inside + " }");
  };
  const auto with_motion = [&](const std::string& inside, const std::string& ahrs = "") {
    return with("falcon {} " + ahrs + " sim_hand { operator { motion {\n " + inside + " } } }");
  };
  const std::string port = "ahrs { serial { path: \"/dev/ttyUSB0\" } }";
  const char* nothing = "means nothing on a Falcon whose grip never turns";
  return {
      {with("twin_delta {} sim_hand {}\n @ahrs { simulated {} }"), "master.ahrs",
       "use the falcon handle"},
      {with("falcon {} sim_hand {}\n @ahrs {}"), "master.ahrs", "add serial {"},
      {with("falcon {} falcon_usb {} ahrs {\n @simulated {} }"), "master.ahrs.simulated",
       "no simulated hand"},
      {with_ahrs("simulated {} @serial { path: \"/dev/ttyUSB0\" }"), "master.ahrs.serial", "; "},
      {with_ahrs("@serial {}"), "master.ahrs.serial.path", "is missing"},
      {with_ahrs("serial { path: \"/dev/ttyUSB0\" baud: @12345 }"), "master.ahrs.serial.baud",
       "is no rate of a serial line; give 9600"},
      {with_ahrs("serial { path: \"/dev/ttyUSB0\" format: @BINARY }"), "master.ahrs.serial.format",
       "NATIVE, VECTORNAV and TEXT"},
      {"rate_hz: 100 " + with("falcon {} sim_hand {} velocity_cutoff_hz: 20\n ahrs { simulated {} "
                              "rate_hz: @120 }"),
       "master.ahrs.rate_hz", "more than one sample per tick"},
      {with_ahrs("simulated {} rate_hz: 50 latency_ms: @10"), "master.ahrs.latency_ms",
       "more than 28 ms"},
      {"rate_hz: 4000 " + with_ahrs("simulated {} latency_ms: @20"), "master.ahrs.latency_ms",
       "more than 85 ticks"},
      {with_ahrs("simulated {} @up_in_master: [0, 0, 0]"), "master.ahrs.up_in_master",
       "such as [0, 1, 0]"},
      {with("falcon {} sim_hand {}", "\n rotation_lock: @true"), "slave.workspace.rotation_lock",
       nothing},
      {with("falcon {} sim_hand {}", "\n alignment_deg: @10"), "slave.workspace.alignment_deg",
       nothing},
      {with("falcon {} sim_hand {} ahrs { simulated {} }", "\n alignment_deg: @10"),
       "slave.workspace.alignment_deg", "counts anew"},
      {with_motion("reach { at_s: 1 @turn_deg: [1, 1, 1] }"),
       "master.sim_hand.operator.motion.reach[0].turn_deg", nothing},
      {with_motion("sine { frequency_hz: 1 @amplitude_deg: [1, 1, 1] }"),
       "master.sim_hand.operator.motion.sine[0].amplitude_deg", nothing},
      {with_motion("sine { frequency_hz: 1 @amplitude_deg: [1, 1, 1] }", port),
       "master.sim_hand.operator.motion.sine[0].amplitude_deg", "simulated {}"},
      {with_motion("trace { max_tilt_deg: @10 }"),
       "master.sim_hand.operator.motion.trace.max_tilt_deg", nothing},
      {with_motion("max_turn_rate_deg_per_s: @10"),
       "master.sim_hand.operator.motion.max_turn_rate_deg_per_s", nothing},
  };
}

}  // namespace farhand
