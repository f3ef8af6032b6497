#include "common/report/run_data.hpp"

#include <algorithm>
#include <cmath>

namespace farhand {
namespace {

constexpr float kNaN = std::numeric_limits<float>::quiet_NaN();

template <std::size_t N, typename Repeated>
void add(Columns<N>& columns, const Repeated& values) {
  for (std::size_t i = 0; i < N; ++i)
    columns[i].push_back(static_cast<int>(i) < values.size()
                             ? static_cast<float>(values.Get(static_cast<int>(i)))
                             : kNaN);
}

void add(Columns<3>& columns, const Vec3& v) {
  for (int i = 0; i < 3; ++i)
    columns[static_cast<std::size_t>(i)].push_back(static_cast<float>(v[i]));
}

template <typename Repeated>
Vec3 vec3(const Repeated& v) {
  return v.size() == 3 ? Vec3(v.Get(0), v.Get(1), v.Get(2)) : Vec3::Constant(kNaN);
}

// NaN if absent or no rotation.
template <typename Repeated>
Mat3 orientation(const Repeated& wxyz) {
  if (wxyz.size() != 4) return Mat3::Constant(kNaN);
  const Quat q(wxyz.Get(0), wxyz.Get(1), wxyz.Get(2), wxyz.Get(3));
  return q.squaredNorm() > 0.5 ? q.normalized().toRotationMatrix() : Mat3(Mat3::Constant(kNaN));
}

// Rotation vector from the first orientation ever seen to R; NaN if R is.
Vec3 turn_since(Mat3& R_first, const Mat3& R) {
  if (!R.allFinite()) return Vec3::Constant(kNaN);
  if (R_first.isZero()) R_first = R;
  return rotation_vector(R * R_first.transpose());
}

// 0 stands for "not yet" and "did not run".
float positive(float x) {
  return x > 0 ? x : kNaN;
}

template <typename Record>
void add_common(SideData& d, std::int64_t log_time_ns, const Record& r) {
  if (d.t.empty()) d.start_ns = log_time_ns;
  d.t.push_back(static_cast<double>(log_time_ns - d.start_ns) * 1e-9);
  d.mode.push_back(static_cast<std::uint8_t>(r.mode()));
  d.coupled.push_back(r.coupled());
  d.limits.push_back(r.limits());
  d.age.push_back(positive(r.age_s()));
  d.round_trip.push_back(positive(r.round_trip_us()));
  const float stages[] = {r.woken_late_us(), r.read_us(), r.compute_us(), r.link_us(),
                          r.write_us()};
  for (std::size_t i = 0; i < d.stages.size(); ++i) d.stages[i].push_back(positive(stages[i]));
  d.busy.push_back(positive(r.read_us() + r.compute_us() + r.link_us() + r.write_us()));
  d.overruns += r.overrun();
  d.overrun_own_us += r.overrun_own_us();
  d.overrun_machine_us += r.overrun_machine_us();
  d.link = {r.received(), r.dropped(), r.lost(), r.reordered(), r.not_sent()};
  if (r.round_trip_us() > 0) d.clock_offset_ns.push_back(r.clock_offset_ns());
}

double end(const SideData& d) noexcept {
  return d.t.empty() ? 0 : d.t.back();
}

}  // namespace

void MasterColumns::add(std::int64_t log_time_ns, const record::MasterRecord& r) {
  add_common(data_, log_time_ns, r);
  farhand::add(data_.position, r.handle_position_m_m());
  farhand::add(data_.turn, turn_since(R_first_, orientation(r.handle_quaternion_m())));
  farhand::add(data_.user_force, r.user_force_g_n());
  farhand::add(data_.user_torque, r.user_torque_g_nm());
  data_.user_estimated = data_.user_estimated || r.user_estimated();
  farhand::add(data_.coupling_force, r.coupling_force_g_n());
  farhand::add(data_.coupling_torque, r.coupling_torque_g_nm());
  farhand::add(data_.environment_force, r.environment_force_g_n());
  farhand::add(data_.environment_torque, r.environment_torque_g_nm());
  farhand::add(data_.force, r.force_g_n());
  farhand::add(data_.torque, r.torque_g_nm());
  farhand::add(data_.target, r.target_position_m_m());
  farhand::add(data_.tau, r.tau_nm());
  data_.position_controlled = data_.position_controlled || r.target_position_m_m_size() == 3;
  for (std::size_t i = 0; i < tau_.size(); ++i) {
    const auto index = static_cast<int>(i);
    const double theta =
        index < r.theta_rad_size() && r.reading_ok() ? r.theta_rad(index) : theta_[i];
    if (data_.size() > 1) work_ += tau_[i] * (theta - theta_[i]);
    theta_[i] = theta;
    tau_[i] = index < r.tau_nm_size() ? r.tau_nm(index) : 0;
  }
  data_.work.push_back(static_cast<float>(work_));
}

void SlaveColumns::add_poses(const record::SlaveRecord& r) {
  const Vec3 p = vec3(r.robot_position_s_m()), p_target = vec3(r.target_position_s_m());
  const Mat3 R = orientation(r.robot_quaternion_s());
  const Mat3 R_target = orientation(r.target_quaternion_s());
  farhand::add(data_.position, p);
  farhand::add(data_.target, p_target);
  farhand::add(data_.turn, turn_since(R_first_, R));
  farhand::add(data_.target_turn, turn_since(R_first_, R_target));
  const bool both = r.coupled() && R.allFinite() && R_target.allFinite();
  data_.position_error.push_back(r.coupled() ? static_cast<float>((p_target - p).norm()) : kNaN);
  data_.rotation_error.push_back(
      both ? static_cast<float>(rotation_vector(R_target * R.transpose()).norm()) : kNaN);
}

void SlaveColumns::add_work(double dt, const record::SlaveRecord& r) {
  const double power =
      vec3(r.contact_force_s_n()).dot(vec3(r.robot_velocity_s_m_per_s())) +
      vec3(r.contact_torque_s_nm()).dot(vec3(r.robot_angular_velocity_s_rad_per_s()));
  const double known = std::isfinite(power) ? power : 0;
  work_ += 0.5 * (power_ + known) * dt;
  power_ = known;
  data_.work.push_back(static_cast<float>(work_));
}

void SlaveColumns::add(std::int64_t log_time_ns, const record::SlaveRecord& r) {
  const double before = end(data_);
  add_common(data_, log_time_ns, r);
  add_poses(r);
  add_work(data_.t.back() - before, r);
  farhand::add(data_.contact_force, r.contact_force_s_n());
  farhand::add(data_.contact_torque, r.contact_torque_s_nm());
  farhand::add(data_.boundary_force, r.boundary_force_s_n());
  farhand::add(data_.boundary_torque, r.boundary_torque_s_nm());
  farhand::add(data_.q, r.q_rad());
  farhand::add(data_.q_command, r.q_command_rad());
  farhand::add(data_.tau, r.tau_nm());
}

double RunData::duration() const noexcept {
  return std::max(master ? end(*master) : 0.0, slave ? end(*slave) : 0.0);
}

std::int64_t RunData::start_ns() const noexcept {
  if (!master || master->t.empty()) return slave ? slave->start_ns : 0;
  if (!slave || slave->t.empty()) return master->start_ns;
  return std::min(master->start_ns, slave->start_ns);
}

}  // namespace farhand
