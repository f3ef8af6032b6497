// Scenes that must be refused, but for those of broken_scenes_ahrs.hpp.
#pragma once

#include "tests/common/broken_scene.hpp"

namespace farhand {

inline std::vector<BrokenScene> broken_scenes() {
  const std::string hand = "twin_delta {} sim_hand {} ";
  const std::string falcon = "falcon {} sim_hand {} position_control {";
  const std::string master = "master { " + hand + "}\n";
  const std::string slave = "slave { sim_arm {} workspace {} joint_pid {} }\n";
  const std::string scene = master + slave;
  const auto with_hand = [&](const std::string& inside) {
    return slave + "master { twin_delta {}\n sim_hand { " + inside + " } }";
  };
  const auto with_operator = [&](const std::string& inside) {
    return with_hand("operator {\n " + inside + " }");
  };
  const auto with_motion = [&](const std::string& inside) {
    return with_operator("motion {\n " + inside + " }");
  };
  const auto with_falcon = [&](const std::string& inside) {
    return slave + "master { falcon {}\n " + inside + " }";
  };
  const auto with_arm = [&](const std::string& inside) {
    return master + "slave { workspace {} joint_pid {}\n sim_arm { " + inside + " } }";
  };
  const auto with_pid = [&](const std::string& inside) {
    return master + "slave { workspace {} sim_arm {}\n joint_pid { " + inside + " } }";
  };
  const auto with_compensation = [&](const std::string& inside) {
    return "master { " + hand +
           "force_feedback {} }\nslave { sim_arm { force_sensor {} } workspace {} joint_pid {} "
           "force_sensing {} }\ncompensation { " +
           inside + " }";
  };
  const auto with_sensing = [&](const std::string& inside) {
    return "master { " + hand +
           "force_feedback {} }\nslave { sim_arm { force_sensor {} } workspace {} joint_pid {}\n "
           "force_sensing { " +
           inside + " } }";
  };
  const auto with_feedback = [&](const std::string& handle, const std::string& inside) {
    return "slave { sim_arm { force_sensor {} } workspace {} joint_pid {} force_sensing {} }\n"
           "master { sim_hand {} " +
           handle + " {} force_feedback {\n " + inside + " } }";
  };
  const auto with_surface = [&](const std::string& inside) {
    return with_arm("surface {\n " + inside + " }");
  };
  const auto with_link = [&](const std::string& inside) {
    return scene + "link {\n " + inside + " }";
  };
  const std::string three_files =
      "authority_file: \"a\" certificate_file: \"b\" private_key_file: \"c\" ";
  const std::string plane = "plane { point_m: [0, 1, 0] normal: [0, -1, 0] } ";

  return {
      // ---- text
      {"@", "scene", "nothing is in this file"},
      {"@# only a remark\n", "scene", "minimal.textproto"},
      {std::string("master@\0 {}", 11), "scene", "not a text file"},
      {"# caf@\xe9 au lait\n", "scene", "UTF-8"},
      {"master @\xc3\xa9 {}", "master", "cannot be '?'; give a message in braces"},
      {"# cut @\xc3", "scene", "UTF-8"},
      {scene + "@}", "scene", "'}' stands where a field should begin"},
      {slave + "@master {\n " + hand + "\n", "master", "never closed; add a '}'"},
      {slave + "master {\n twin_delta {}\n @sim_hand {\n", "master.sim_hand", "never closed"},
      {scene + "description: \"no end@\n", "description", "correct the text"},
      {scene + "@[farhand.other]: 1", "scene", "where a field should begin"},
      // ---- names
      {scene + "@rate_hertz: 100", "rate_hertz", "did you mean rate_hz?"},
      {scene + "@velocity: 1", "velocity", "Scene knows description, rate_hz, seed"},
      {with_motion("sine { @frequenzy_hz: 1 }"),
       "master.sim_hand.operator.motion.sine[0].frequenzy_hz",
       "did you mean frequency_hz? Sine knows from_s"},
      {with_arm("surface { } surface { @plain { } }"), "slave.sim_arm.surface[1].plain",
       "did you mean plane?"},
      {scene + "@Link { }", "Link", "did you mean link?"},
      {master +
           "slave { sim_arm {} workspace {} joint_pid {\n gravity_compensation { @share: 1 } } }",
       "slave.joint_pid.gravity_compensation.share", "has no fields"},
      // ---- kinds of values
      {scene + "rate_hz: @fast", "rate_hz", "cannot be 'fast'; give from 50 to 4000 Hz"},
      {scene + "rate_hz: @\"100\"", "rate_hz", "from 50 to 4000 Hz"},
      {scene + "rate_hz: @", "rate_hz", "has no value"},
      {scene + "@rate_hz 100", "rate_hz", "write rate_hz: 100"},
      {scene + "rate_hz: @[100]", "rate_hz", "cannot be '['"},
      {scene + "rate_hz: @{ }", "rate_hz", "cannot be '{'"},
      {scene + "seed: @-1", "seed", "a whole number from 0"},
      {scene + "seed: @1.5", "seed", "a whole number"},
      {scene + "seed: @18446744073709551616", "seed", "to 18446744073709551615"},
      {scene + "description: @7", "description", "text in double quotes"},
      {scene + "link: @127", "link", "a message in braces, link { ... }"},
      {with_arm("friction: @maybe"), "slave.sim_arm.friction", "true or false"},
      {slave + "master { sim_hand {} falcon {\n geometry: @TABEL1 } }", "master.falcon.geometry",
       "did you mean TABLE1? give one of TABLE1, TABLE1_S0, TABLE1_FLIP and LIBNIFALCON"},
      {with_operator("press { at_s: 1 button: @DEADMAN }"),
       "master.sim_hand.operator.press[0].button", "DEAD_MAN and CLUTCH"},
      {with_arm("start_deg: [0, 0, @zero, 0, 0, 0]"), "slave.sim_arm.start_deg[2]",
       "6 numbers, each from -360 to 360 deg"},
      // ---- twice
      {scene + "rate_hz: 100\n@rate_hz: 100", "rate_hz", "given twice"},
      {scene + "link {}\n@link {}", "link", "give it once"},
      {slave + "master { sim_hand {} twin_delta {}\n @falcon {} }", "master.falcon",
       "twin_delta is already chosen as the handle"},
      {with_surface(plane + "@sphere { centre_m: [0, 0, 0] radius_m: 1 }"),
       "slave.sim_arm.surface[0].sphere", "keep one of the two"},
      // ---- numbers
      {scene + "rate_hz: @49.9", "rate_hz", "49.9 Hz is too small; give from 50 to 4000 Hz"},
      {scene + "rate_hz: @4001", "rate_hz", "too large"},
      {scene + "rate_hz: @-100", "rate_hz", "-100 Hz is too small"},
      {scene + "rate_hz: @nan", "rate_hz", "nan is not finite"},
      {scene + "duration_s: @-inf", "duration_s", "not finite"},
      {scene + "duration_s: @1e999", "duration_s", "not finite"},
      {with_hand("push { at_s: 1 force_newton: [1, 2, 3] }\n push { at_s: 2 force_newton: [1, "
                 "@101, 3] }"),
       "master.sim_hand.push[1].force_newton[1]",
       "101 N is too large; give 3 numbers, each from -100 to 100 N"},
      {with_hand("push { at_s: 1 force_newton: 1 force_newton: 2 force_newton: @-101 }"),
       "master.sim_hand.push[0].force_newton[2]", "too small"},
      {with_hand(
           "push [ { at_s: 1 force_newton: [1, 2, 3] },\n { at_s: @-2 force_newton: [1, 2, 3] } ]"),
       "master.sim_hand.push[1].at_s", "-2 s"},
      // ---- lengths, missing values
      {with_hand("push { at_s: 1 @force_newton: [1, 2] }"), "master.sim_hand.push[0].force_newton",
       "has 2 values; give 3 numbers"},
      {with_arm("@start_deg: [1, 2, 3, 4, 5, 6, 7]"), "slave.sim_arm.start_deg",
       "has 7 values; give 6"},
      {with_hand("@push { at_s: 1 }"), "master.sim_hand.push[0].force_newton", "is missing"},
      {with_motion("@sine { amplitude_m: [0, 0.01, 0] }"),
       "master.sim_hand.operator.motion.sine[0].frequency_hz", "add frequency_hz"},
      {with_surface("@sphere { centre_m: [0, 0, 0] }"), "slave.sim_arm.surface[0].sphere.radius_m",
       "is missing"},
      // ---- scene and master
      {"@" + slave, "master", "one file describes both sides"},
      {"@" + master, "slave", "would move nothing"},
      {"master { " + falcon + "} }\n@" + slave, "slave", "nothing to follow"},
      {"master { " + falcon + "} }\n@link {}", "link", "leads nowhere"},
      {slave + "@master { sim_hand {} }", "master", "add falcon {} or twin_delta {}"},
      {slave + "@master { twin_delta {} }", "master", "add sim_hand {}"},
      {"master { " + hand + "\n @position_control {} }", "master.position_control",
       "is for the Falcon"},
      {"master { " + falcon + "}\n @force_feedback {} }", "master.force_feedback",
       "drive the motors; keep one"},
      {slave + "master { " + hand + "\n @force_feedback {} }", "master.force_feedback",
       "add force_sensing {}"},
      {slave + "master { " + hand + "\n velocity_cutoff_hz: @500 }", "master.velocity_cutoff_hz",
       "500 Hz is not below half the tick rate"},
      {"rate_hz: 100\n" + slave + "@" + master, "master.velocity_cutoff_hz",
       "60 Hz is not below half"},
      {"master { " + hand +
           "force_feedback {\n fade_ms: @500 } }\nslave { sim_arm { force_sensor {} } workspace {} "
           "joint_pid {} force_sensing {} }",
       "master.force_feedback.fade_ms", "would outlast the peer"},
      // ---- Falcon
      {slave + "master { twin_delta {} @falcon_usb {} }", "master.falcon_usb",
       "use falcon {} as the handle"},
      {with_falcon("sim_hand { twist_inertia_kg_m2: @1e-3 }"),
       "master.sim_hand.twist_inertia_kg_m2", "use the twin_delta"},
      {with_falcon("sim_hand { operator { twist_stiffness_newton_m_per_rad: @1 } }"),
       "master.sim_hand.operator.twist_stiffness_newton_m_per_rad", "neither turns"},
      {"master { falcon {} sim_hand {} force_feedback {\n max_torque_newton_meter: @1 } }\nslave { "
       "sim_arm { force_sensor {} } workspace {} joint_pid {} force_sensing {} }",
       "master.force_feedback.max_torque_newton_meter", "means nothing on a Falcon"},
      {with_feedback("twin_delta", "@closed_loop {}"), "master.force_feedback.closed_loop",
       "add force_sensing {} to the master"},
      {with_feedback("falcon", "@closed_loop {}"), "master.force_feedback.closed_loop",
       "a Falcon senses none"},
      {with_feedback("falcon",
                     "device_model {} disturbance_observer {} closed_loop {\n @twist {} }"),
       "master.force_feedback.closed_loop.twist", "means nothing on a Falcon"},
      {with_feedback("twin_delta", "@device_feedforward {}"),
       "master.force_feedback.device_feedforward", "add device_model {}"},
      {with_feedback("falcon", "@contact_damping {}"), "master.force_feedback.contact_damping",
       "add device_model {}"},
      {with_feedback("falcon", "@disturbance_observer {}"),
       "master.force_feedback.disturbance_observer", "add device_model {}"},
      {with_feedback("twin_delta", "device_model {}\n @disturbance_observer {}"),
       "master.force_feedback.disturbance_observer", "take the user for a disturbance"},
      {with_feedback("falcon", "device_model {\n motor_delay_ms: @8 }"),
       "master.force_feedback.device_model.motor_delay_ms", "more than seven ticks"},
      {with_feedback("twin_delta {} force_sensing",
                     "closed_loop { axis { axis: TWIST gains {} }\n @axis { axis: TWIST gains {} } "
                     "}"),
       "master.force_feedback.closed_loop.axis[1]", "names an axis a second time"},
      {with_feedback("twin_delta {} force_sensing", "closed_loop { twist {\n cutoff_hz: @600 } }"),
       "master.force_feedback.closed_loop.twist.cutoff_hz", "600 Hz is not below half"},
      {with_feedback("falcon",
                     "device_model {} device_feedforward {\n rotation_inertia_share: @0.5 }"),
       "master.force_feedback.device_feedforward.rotation_inertia_share",
       "means nothing on a Falcon"},
      {"master { " + falcon + "\n derivative_cutoff_hz: @600 } }",
       "master.position_control.derivative_cutoff_hz", "600 Hz is not below half"},
      {"rate_hz: 100 master { velocity_cutoff_hz: 20 " + falcon + "\n kd_newton_s_per_m: @500 } }",
       "master.position_control.kd_newton_s_per_m", "would vibrate"},
      {"master { " + falcon +
           "\n set_point { at_s: 1 position_m: [0, 0, 0] }\n @set_point { at_s: 1 position_m: [0, "
           "0, 0] } } }",
       "master.position_control.set_point[1]", "in the order of at_s"},
      {"master { " + falcon + "\n @park { position_m: [0, 0, 0.1] } } }",
       "master.position_control.park", "add max_speed_m_per_s"},
      {"master { " + falcon + "\n max_force_rate_newton_per_s: @100 } }",
       "master.position_control.max_force_rate_newton_per_s", "acts only in safe motion"},
      {"rate_hz: 100 master { velocity_cutoff_hz: 20 " + falcon +
           "kd_newton_s_per_m: 0\n max_speed_m_per_s: @0.005 } }",
       "master.position_control.max_speed_m_per_s", "would make the handle vibrate"},
      {"master { " + falcon +
           "max_speed_m_per_s: 0.1 gravity_mass_kg: 1\n max_force_newton: @8 } }",
       "master.position_control.max_force_newton", "does not exceed the weight"},
      {"master { " + falcon + "danger_cue {\n max_shift_m: @0.03 } } }",
       "master.position_control.danger_cue.max_shift_m", "too large"},
      {"master { " + falcon + "danger_cue {\n contact_newton: @10 } } }\n" + slave,
       "master.position_control.danger_cue.contact_newton", "nothing senses"},
      // ---- guidance
      {slave + "master { " + hand + "\n @guidance { handle_limits {} } }", "master.guidance",
       "add force_feedback {}"},
      {slave + "master { " + hand + "force_feedback {}\n @guidance {} }", "master.guidance",
       "guides nothing"},
      {slave + "master { " + hand + "force_feedback {} guidance {\n @fixture {} } }",
       "master.guidance.fixture[0]", "add plane { ... }, axis { ... } or sphere { ... }"},
      {slave + "master { " + hand +
           "force_feedback {} guidance { fixture { plane { point_m: [0, 0, 0]\n @normal: [0, 0, 0] "
           "} } } }",
       "master.guidance.fixture[0].plane.normal", "has no length"},
      {slave + "master { " + hand +
           "force_feedback {} guidance { fixture { axis { point_m: [0, 0, 0]\n @direction: [0, 0, "
           "0] } } } }",
       "master.guidance.fixture[0].axis.direction", "has no length"},
      {"master { " + hand +
           "}\nslave { sim_arm {} joint_pid {}\n workspace { rotation_lock: true "
           "alignment_deg: @10 } }",
       "slave.workspace.alignment_deg", "remove one of the two"},
      // ---- hand
      {"rate_hz: 2000 " + with_hand("rate_hz: @1500"), "master.sim_hand.rate_hz",
       "less than one step per tick"},
      {with_hand("rate_hz: @1000 device_mass_kg: 0.01 device_damping_newton_s_per_m: 50"),
       "master.sim_hand.rate_hz", "1000 Hz is too coarse"},
      {with_operator("press { button: CLUTCH at_s: 1 lasting_s: 2 }\n press { button: DEAD_MAN "
                     "at_s: 1 }\n @press { button: CLUTCH at_s: 2.5 }"),
       "master.sim_hand.operator.press[2]", "overlaps an earlier press"},
      {with_operator(
           "press { button: DEAD_MAN at_s: 1 }\n @press { button: DEAD_MAN at_s: 5 lasting_s: 1 }"),
       "master.sim_hand.operator.press[1]", "give the earlier one a lasting_s"},
      {with_operator("@press { button: CLUTCH at_s: 1 lasting_s: 1 }"),
       "master.sim_hand.operator.press", "add press { button: DEAD_MAN"},
      {with_motion("@trace {} sine { frequency_hz: 1 amplitude_m: [0, 0.01, 0] }"),
       "master.sim_hand.operator.motion.trace", "cannot be combined"},
      {with_motion("@sine { frequency_hz: 2 amplitude_m: [0, 0.05, 0] }"),
       "master.sim_hand.operator.motion.sine[0]", "max_speed_m_per_s"},
      {with_motion("@sine { frequency_hz: 2 amplitude_deg: [0, 0, 20] }"),
       "master.sim_hand.operator.motion.sine[0]", "max_turn_rate_deg_per_s"},
      {with_motion("sine { frequency_hz: 1 from_s: 2 until_s: @2 amplitude_m: [0, 0.01, 0] }"),
       "master.sim_hand.operator.motion.sine[0].until_s", "2 s is not after from_s"},
      {with_motion("@sine { frequency_hz: 1 }"), "master.sim_hand.operator.motion.sine[0]",
       "moves nothing"},
      {"rate_hz: 50 link { stale_ms: 60 cut_off_us: 0 } master { twin_delta {} velocity_cutoff_hz: "
       "20 sim_hand { operator { motion {\n"
       "sine { frequency_hz: @25 amplitude_m: [0, 0.001, 0] } } } } } slave { sim_arm {} workspace "
       "{} joint_pid { bandwidth_hz: 1 } }",
       "master.sim_hand.operator.motion.sine[0].frequency_hz",
       "25 Hz is not below half the tick rate"},
      {with_motion("@reach { at_s: 1 lasting_s: 0.2 by_m: [0.06, 0, 0] }"),
       "master.sim_hand.operator.motion.reach[0]", "longer lasting_s"},
      {with_motion("@reach { at_s: 1 lasting_s: 0.2 turn_deg: [0, 20, 0] }"),
       "master.sim_hand.operator.motion.reach[0]", "turns faster"},
      {with_motion("@reach { at_s: 1 }"), "master.sim_hand.operator.motion.reach[0]", "add by_m"},
      // ---- slave
      {master + "@slave { workspace {} joint_pid {} }", "slave", "add sim_arm {}"},
      {master + "@slave { sim_arm {} joint_pid {} }", "slave.workspace", "add workspace {}"},
      {master + "@slave { sim_arm {} workspace {} }", "slave.joint_pid", "add joint_pid {}"},
      {master +
           "slave { sim_arm { force_sensor {} } workspace {} joint_pid {}\n @force_sensing {} }",
       "slave.force_sensing", "nobody reflects"},
      {"master { " + hand +
           "force_feedback {} }\nslave { sim_arm {} workspace {} joint_pid {}\n @force_sensing {} "
           "}",
       "slave.force_sensing", "add force_sensor {} to sim_arm"},
      {with_arm("@force_sensor {}"), "slave.sim_arm.force_sensor", "is read by nobody"},
      {master + "slave { sim_arm { friction: false } workspace {} joint_pid {\n "
                "@friction_compensation {} } }",
       "slave.joint_pid.friction_compensation", "no friction"},
      {with_pid("derivative_cutoff_hz: @700"), "slave.joint_pid.derivative_cutoff_hz",
       "not below half"},
      {with_pid("velocity_feedforward { cutoff_hz: @600 }"),
       "slave.joint_pid.velocity_feedforward.cutoff_hz", "not below half"},
      {with_pid("bandwidth_hz: @90"), "slave.joint_pid.bandwidth_hz", "would vibrate; lower it"},
      {with_sensing("cutoff_hz: @500"), "slave.force_sensing.cutoff_hz", "not below half"},
      {with_sensing("@tool_com_m: [0, 0, 0.1]"), "slave.force_sensing.tool_com_m",
       "add tool_mass_kg"},
      {"rate_hz: 2000 " + with_arm("rate_hz: @1500"), "slave.sim_arm.rate_hz",
       "less than one step"},
      {with_arm("@surface {}"), "slave.sim_arm.surface[0]",
       "add plane { ... }, sphere { ... } or box { ... }"},
      {with_surface(plane + "stiffness_newton_per_m: @1e6 damping_newton_s_per_m: 100"),
       "slave.sim_arm.surface[0].stiffness_newton_per_m", "too hard for the arm's"},
      {with_surface("plane { point_m: [0, 1, 0] @normal: [0, 0, 0] }"),
       "slave.sim_arm.surface[0].plane.normal", "has no length"},
      // ---- link
      {with_link("slave_address: @\"robot:47810\""), "link.slave_address",
       "'robot:47810' is no address"},
      {with_link("slave_address: @\"127.0.0.1\""), "link.slave_address", "host:port"},
      {with_link("master_address: @\"127.0.0.1:65536\""), "link.master_address", "from 0 to 65535"},
      {with_link("slave_address: @\"127.0.0.1:0\""), "link.slave_address",
       "would not know where to send"},
      {with_link("slave_address: @\"10.0.0.2:47810\""), "link.slave_address", "unauthenticated"},
      {with_link("master_address: @\"[::]:47811\""), "link.master_address", "add insecure: true"},
      {with_link("slave_address: @\"10.0.0.2:47810\""), "link.slave_address", "farhand-keygen"},
      {with_link("key_file: @\"\""), "link.key_file", "names no file"},
      {with_link("key_file: \"a.key\" insecure: @true"), "link.insecure", "contradicts key_file"},
      {with_link("key_file: \"a.key\" @certificates { " + three_files + "}"), "link.certificates",
       "leave in one of them"},
      {with_link("insecure: true @certificates { " + three_files + "}"), "link.certificates",
       "contradicts"},
      {with_link("certificates { authority_file: @\"\" certificate_file: \"b\" "
                 "private_key_file: \"c\" }"),
       "link.certificates.authority_file", "names no file"},
      {with_link("certificates { authority_file: \"a\" certificate_file: @\"\" "
                 "private_key_file: \"c\" }"),
       "link.certificates.certificate_file", "names no file"},
      {with_link("certificates { authority_file: \"a\" certificate_file: \"b\" "
                 "private_key_file: @\"\" }"),
       "link.certificates.private_key_file", "names no file"},
      {with_link(
           "insecure: true slave_address: \"10.0.0.2:47810\"\n master_address: @\"127.0.0.1:0\""),
       "link.master_address", "0.0.0.0:0"},
      {with_link("slave_address: \"[::1]:47810\"\n master_address: @\"127.0.0.1:0\""),
       "link.master_address", "one family"},
      {with_link("master_address: @\"localhost:47810\""), "link.master_address",
       "the slave's address too"},
      {with_link("observer_address: @\"lab\""), "link.observer_address", "no address"},
      {with_link("observer_address: @\"10.0.0.3:47820\""), "link.observer_address",
       "beyond this machine"},
      {with_link("observer_address: @\"127.0.0.1:0\""), "link.observer_address", "port 0"},
      {with_link("cut_off_us: @1000"), "link.cut_off_us",
       "1000 us is not less than the tick period"},
      {"rate_hz: 4000\nmaster { velocity_cutoff_hz: 60 " + hand +
           "}\nslave { sim_arm { rate_hz: 4000 } workspace {} joint_pid {} }@",
       "link.cut_off_us", "400 us is not less"},
      {slave + "master { " + hand + "realtime { cpu: @1024 } }", "master.realtime.cpu", "nproc"},
      {master + "slave { sim_arm {} workspace {} joint_pid {} realtime { spin_us: @251 } }",
       "slave.realtime.spin_us", "a quarter of the tick period"},
      {"master { " + hand +
           "force_feedback {} }\nslave { sim_arm { force_sensor {} } workspace {} joint_pid {} "
           "force_sensing {} }\n@compensation {}",
       "compensation", "names no method"},
      {"master { " + hand +
           "force_feedback {} }\nslave { sim_arm { force_sensor {} } workspace {} joint_pid {} "
           "force_sensing {} boundary {} }\n@compensation { mmt {} }",
       "compensation", "use damped {}"},
      {with_compensation("smith {\n @wall { point_in_slave_m: [0, 0, 0] } }"),
       "compensation.smith.wall.normal_in_slave", "is missing"},
      {with_compensation("smith { wall { point_in_slave_m: [0, 0, 0]\n"
                         " @normal_in_slave: [0, 0, 0] } }"),
       "compensation.smith.wall.normal_in_slave", "has no length"},
      {with_compensation("wave {} } link {\n @deadband {}"), "link.deadband", "with direct {}"},
      {with_compensation("direct {} } link { cut_off_us: 300\n @deadband {}"), "link.deadband",
       "waited for in vain"},
      {with_compensation("direct {} } link { stale_ms: 30 deadband { keep_alive_ms: @16 }"),
       "link.deadband.keep_alive_ms", "half of link.stale_ms"},
      {with_compensation("direct {} } link { stale_ms: 60 deadband { keep_alive_ms: @11 }"),
       "link.deadband.keep_alive_ms", "half of force_feedback.hold_ms"},
      {with_compensation("wave { impedance_newton_s_per_m: 400\n virtual_mass_kg: @0.05 }"),
       "compensation.wave.virtual_mass_kg", "too light for the impedance"},
      {with_compensation("smith { wall { point_in_slave_m: [0, 0, 0] normal_in_slave: [0, 1, 0] }\n"
                         " robot_mass_kg: @0.05 }"),
       "compensation.smith.robot_mass_kg", "too light for the model"},
      {with_link("\n@deadband {}"), "link.deadband", "nothing senses"},
      {"rate_hz: 500 " + with_link("stale_ms: @3"), "link.stale_ms", "two tick periods"},
      {with_link("stale_ms: 50\n max_late_ms: @49"), "link.max_late_ms", "less than stale_ms"},
      {with_link("stale_ms: @500"), "link.stale_ms", "not less than lost_ms"},
      {with_link("to_master { delay_ms: 1 jitter: UNIFORM jitter_ms: @2 }"),
       "link.to_master.jitter_ms", "use jitter: GAMMA"},
      {with_link("to_master { burst_enter_ratio: 0.1 burst_leave_ratio: @0 }"),
       "link.to_master.burst_leave_ratio", "never ends"},
      {with_link("to_slave { blackout { length_s: 2 period_s: @1 } }"),
       "link.to_slave.blackout[0].period_s", "nothing ever passes"},
  };
}

}  // namespace farhand
