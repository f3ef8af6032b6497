#include "slave/record.hpp"

#include <spdlog/fmt/fmt.h>

#include "common/record_fields.hpp"
#include "proto/foxglove.pb.h"

namespace farhand {
namespace {

void fill_reading(record::SlaveRecord& to, const RobotReading& from) {
  to.set_reading_ok(from.ok);
  append(to.mutable_q_rad(), from.q);
  append(to.mutable_dq_rad_per_s(), from.dq);
  append(to.mutable_sensor_force_s_n(), from.F_E_S.force);
  append(to.mutable_sensor_torque_s_nm(), from.F_E_S.torque);
}

void fill_tick(record::SlaveRecord& to, const SlaveTick& from) {
  to.set_mode(static_cast<record::Mode>(from.mode));
  to.set_reason(static_cast<record::Reason>(from.reason));
  to.set_coupled(from.coupled);
  if (from.age < Duration::max()) to.set_age_s(plotted(seconds(from.age)));
  append(to.mutable_robot_position_s_m(), from.X_SE.p);
  append(to.mutable_robot_quaternion_s(), from.out.q_SE);
  append(to.mutable_robot_velocity_s_m_per_s(), from.out.V_SE.linear);
  append(to.mutable_robot_angular_velocity_s_rad_per_s(), from.out.V_SE.angular);
  append(to.mutable_target_position_s_m(), from.X_SE_target.p);
  append(to.mutable_target_quaternion_s(), to_quat(from.X_SE_target.R));
  append(to.mutable_q_command_rad(), from.q_cmd);
  append(to.mutable_tau_nm(), from.tau);
  append(to.mutable_contact_force_s_n(), from.F_E_S.force);
  append(to.mutable_contact_torque_s_nm(), from.F_E_S.torque);
  to.set_wrist_singularity(plotted(from.singularity.wrist));
  to.set_elbow_singularity(plotted(from.singularity.elbow));
  to.set_shoulder_singularity(plotted(from.singularity.shoulder));
  to.set_inverse_status(static_cast<std::uint32_t>(from.inverse));
  to.set_limits(from.limits);
}

std::string numbers(const Vec6& v) {
  return fmt::format("{}", fmt::join(v, " "));
}

}  // namespace

void fill(record::SlaveRecord& to, const SlaveRecord& from, const SlaveConfig& slave) {
  fill_reading(to, from.tick.robot);
  fill_tick(to, from.tick);
  if (slave.boundary && slave.workspace.force_scale > 0) {
    const Wrench F_E_S = boundary_wrench(slave.workspace, from.tick);
    append(to.mutable_boundary_force_s_n(), F_E_S.force);
    append(to.mutable_boundary_torque_s_nm(), F_E_S.torque);
  }
  if (slave.workspace.alignment) append(to.mutable_handle_turn_m_rad(), from.tick.turn_M);
  set_timing(to, from.timing);
  set_link(to, from.link);
}

SlaveRecording::SlaveRecording(RecordingFile& file, const SlaveConfig& slave)
    : file_(file),
      slave_(slave),
      ticks_(file.channel(kSlaveTopic, *record::SlaveRecord::descriptor())),
      pose_(file.channel("/robot/pose", *foxglove::PoseInFrame::descriptor())),
      target_(file.channel("/robot/target", *foxglove::PoseInFrame::descriptor())),
      transforms_(file.channel("/tf", *foxglove::FrameTransform::descriptor())) {
  Vec6 torque;
  for (int i = 0; i < 6; ++i) torque[i] = slave.model.links[i].torque_limit;
  file.add_metadata(kRobotMetadata, {{"q_lower_rad", numbers(slave.joints.lower)},
                                     {"q_upper_rad", numbers(slave.joints.upper)},
                                     {"joint_torque_nm", numbers(torque)}});
}

void SlaveRecording::add(const SlaveRecord& r) {
  const SlaveTick& t = r.tick;
  message_.Clear();
  fill(message_, r, slave_);
  file_.write(ticks_, t.now, message_);
  if (!viewers_.due(t.now)) return;
  file_.write_pose(pose_, t.now, "S", t.X_SE);
  file_.write_pose(target_, t.now, "S", t.X_SE_target);
  file_.write_transform(transforms_, t.now, "S", "E", t.X_SE);
  file_.write_transform(transforms_, t.now, "S", "M", Pose{slave_.workspace.R_SM, Vec3::Zero()});
}

}  // namespace farhand
