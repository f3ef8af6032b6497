#include "master/record.hpp"

#include <stdexcept>

#include "common/mcap_reader.hpp"
#include "common/record_fields.hpp"
#include "common/scene_bilateral.hpp"
#include "proto/foxglove.pb.h"

namespace farhand {
namespace {

static_assert(static_cast<int>(AhrsState::lost) == record::AHRS_LOST);

template <typename Field>
bool take(const Field& from, double* to, int size) noexcept {
  if (from.size() != size) return false;
  std::copy(from.begin(), from.end(), to);
  return true;
}

void fill_sample(record::MasterRecord& to, const AhrsSample& from) {
  append(to.mutable_ahrs_angular_rate_i_rad_per_s(), from.gyro);
  append(to.mutable_ahrs_specific_force_i_m_per_s2(), from.acceleration);
  if (from.magnetic) append(to.mutable_ahrs_magnetic_field_i_t(), *from.magnetic);
  if (from.attitude) append(to.mutable_ahrs_attitude(), *from.attitude);
  if (from.time) to.set_ahrs_time_ns(from.time->count());
}

// Nothing: none was recorded, or not as this program does it.
std::optional<AhrsSample> ahrs_sample(const record::MasterRecord& from) noexcept {
  AhrsSample out;
  if (!take(from.ahrs_angular_rate_i_rad_per_s(), out.gyro.data(), 3) ||
      !take(from.ahrs_specific_force_i_m_per_s2(), out.acceleration.data(), 3))
    return {};
  Vec3 magnetic;
  if (take(from.ahrs_magnetic_field_i_t(), magnetic.data(), 3)) out.magnetic = magnetic;
  double q[4];
  if (take(from.ahrs_attitude(), q, 4)) out.attitude = Quat(q[0], q[1], q[2], q[3]);
  if (from.has_ahrs_time_ns()) out.time = Duration(from.ahrs_time_ns());
  return out;
}

void fill_reading(record::MasterRecord& to, const HandleReading& from, int motors) {
  to.set_reading_ok(from.ok);
  to.set_dead_man(from.dead_man);
  to.set_clutch(from.clutch);
  to.set_has_force(from.has_force);
  append(to.mutable_theta_rad(), std::span(from.theta.data(), static_cast<std::size_t>(motors)));
  if (from.ahrs) fill_sample(to, *from.ahrs);
  if (!from.has_force) return;
  append(to.mutable_upper_sensor_force_m_n(), from.ends.f_E1_M);
  append(to.mutable_lower_sensor_force_a2_n(), from.ends.f_E2_A2);
}

void fill_tick(record::MasterRecord& to, const MasterTick& from, const RecordedMaster& master) {
  to.set_mode(static_cast<record::Mode>(from.mode));
  to.set_reason(static_cast<record::Reason>(from.reason));
  if (master.aligns) append(to.mutable_handle_turn_m_rad(), from.turn_M);
  append(to.mutable_handle_position_m_m(), from.handle.X_MH.p);
  append(to.mutable_handle_quaternion_m(), from.out.q_MH);
  append(to.mutable_handle_velocity_m_m_per_s(), from.out.V_MH.linear);
  append(to.mutable_handle_angular_velocity_m_rad_per_s(), from.out.V_MH.angular);
  if (from.has_ahrs) {
    to.set_ahrs_state(static_cast<record::AhrsState>(from.ahrs));
    to.set_ahrs_tilt_sigma_rad(plotted(from.tilt_sigma));
    to.set_ahrs_yaw_sigma_rad(plotted(from.yaw_sigma));
  }
  if (from.age < Duration::max()) to.set_age_s(plotted(seconds(from.age)));
  to.set_user_estimated(from.user_estimated);
  if (from.user_felt || from.user_estimated) {
    append(to.mutable_user_force_g_n(), from.F_user_G.force);
    append(to.mutable_user_torque_g_nm(), from.F_user_G.torque);
  }
  append(to.mutable_environment_force_g_n(), from.F_env_G.force);
  append(to.mutable_environment_torque_g_nm(), from.F_env_G.torque);
  if (master.coupled) {
    append(to.mutable_coupling_force_g_n(), from.F_coupling_G.force);
    append(to.mutable_coupling_torque_g_nm(), from.F_coupling_G.torque);
  }
  append(to.mutable_force_g_n(), from.F_G.force);
  append(to.mutable_torque_g_nm(), from.F_G.torque);
  append(to.mutable_tau_nm(), std::span(from.tau.data(), static_cast<std::size_t>(master.motors)));
  if (from.position_controlled) append(to.mutable_target_position_m_m(), from.p_MH_target);
  to.set_method(static_cast<record::Method>(from.out.method));
  to.set_limits(from.limits);
  to.set_slave_mode(static_cast<record::Mode>(from.slave_mode));
  to.set_slave_reason(static_cast<record::Reason>(from.slave_reason));
  to.set_coupled(from.coupled);
}

}  // namespace

void fill(record::MasterRecord& to, const MasterRecord& from, const RecordedMaster& master) {
  fill_reading(to, from.tick.reading, master.motors);
  fill_tick(to, from.tick, master);
  set_timing(to, from.timing);
  set_link(to, from.link);
}

HandleReading handle_reading(const record::MasterRecord& from) noexcept {
  constexpr int kFalconMotors = 3, kTwinDeltaMotors = 6;
  HandleReading out{.ok = from.reading_ok(),
                    .dead_man = from.dead_man(),
                    .clutch = from.clutch(),
                    .has_force = from.has_force(),
                    .ahrs = ahrs_sample(from)};
  out.ok &= take(from.theta_rad(), out.theta.data(), kFalconMotors) ||
            take(from.theta_rad(), out.theta.data(), kTwinDeltaMotors);
  if (out.has_force)
    out.ok &= take(from.upper_sensor_force_m_n(), out.ends.f_E1_M.data(), 3) &&
              take(from.lower_sensor_force_a2_n(), out.ends.f_E2_A2.data(), 3);
  return out;
}

std::vector<HandleReading> read_readings(McapReader& reader) {
  std::vector<HandleReading> out;
  record::MasterRecord tick;
  for (McapReader::Message m; reader.next(m);)
    if (m.topic == kMasterTopic &&
        tick.ParseFromArray(m.data.data(), static_cast<int>(m.data.size())))
      out.push_back(handle_reading(tick));
  if (out.empty())
    throw std::runtime_error("this recording holds no ticks of a master: give a master's one");
  return out;
}

MasterRecording::MasterRecording(RecordingFile& file, const proto::Scene& scene)
    : file_(file),
      master_{.motors = scene.master().has_falcon() ? 3 : 6,
              .coupled = scene.master().has_force_feedback() && channels(scene).robot_position,
              .aligns = scene.slave().workspace().has_alignment_deg()},
      ticks_(file.channel(kMasterTopic, *record::MasterRecord::descriptor())),
      pose_(file.channel("/handle/pose", *foxglove::PoseInFrame::descriptor())),
      transforms_(file.channel("/tf", *foxglove::FrameTransform::descriptor())) {}

void MasterRecording::add(const MasterRecord& r) {
  message_.Clear();
  fill(message_, r, master_);
  file_.write(ticks_, r.tick.now, message_);
  if (!viewers_.due(r.tick.now)) return;
  file_.write_pose(pose_, r.tick.now, "M", r.tick.handle.X_MH);
  file_.write_transform(transforms_, r.tick.now, "M", "H", r.tick.handle.X_MH);
}

}  // namespace farhand
