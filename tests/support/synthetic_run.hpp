// Records of a made-up run whose every figure is known: free for the first half, in contact after
// it. What the report's tests and its timing are made with.
#pragma once

#include <cmath>
#include <cstdint>
#include <string>

#include "common/mcap_writer.hpp"
#include "common/report/run_data.hpp"
#include "proto/record.pb.h"

namespace farhand {

struct SyntheticRun {
  std::int64_t start_ns = 1'800'000'000'000'000'000;  // log time of the master's first tick
  std::int64_t ticks = 2000;                          // of 1 ms
  // Exact errors.
  double tracking_free_m = 1e-3, tracking_contact_m = 2e-3;
  double force_error_free_n = 0.5, force_error_contact_n = 1.5;
  double contact_n = 4;  // along z of S, -x of G
  bool user_estimated = false;
  double coupling_n = 0, boundary_n = 0;  // 0: not recorded

  bool touching(std::int64_t tick) const { return tick >= ticks / 2; }
  std::int64_t master_time(std::int64_t tick) const { return start_ns + tick * 1'000'000; }
};

namespace synthetic {

template <typename Field>
void set3(Field* field, double x, double y, double z) {
  field->Clear();
  for (const double v : {x, y, z}) field->Add(static_cast<typename Field::value_type>(v));
}

template <typename Record>
void add_costs(Record& r, std::int64_t tick) {
  r.set_woken_late_us(20 + static_cast<float>(tick % 7));
  r.set_read_us(2);
  r.set_compute_us(tick % 100 == 0 ? 40 : 4);
  r.set_link_us(10);
  r.set_wait_us(150);
  r.set_write_us(1);
  r.set_round_trip_us(tick % 2 == 0 ? 180 : 200);
  r.set_received(static_cast<std::uint64_t>(tick));
  r.set_lost(3);
  r.set_reordered(1);
}

}  // namespace synthetic

// Along x of M as A sin(w t); the slave's clock is `clock_offset_ns` ahead.
inline record::MasterRecord master_record(const SyntheticRun& run, std::int64_t tick,
                                          std::int64_t clock_offset_ns = 0) {
  const double t = static_cast<double>(tick) * 1e-3, x = 0.03 * std::sin(4 * t);
  const double f = run.touching(tick) ? run.contact_n : 0;
  record::MasterRecord r;
  r.set_reading_ok(true);
  for (int i = 0; i < 6; ++i) r.add_theta_rad(0.1 * i + 0.5 * t);
  for (int i = 0; i < 6; ++i) r.add_tau_nm(static_cast<float>(i == 0 ? 0.2 : 0));
  r.set_mode(tick < 10 ? record::MODE_READY : record::MODE_ENGAGED);
  r.set_coupled(tick >= 10);
  synthetic::set3(r.mutable_handle_position_m_m(), 0.18 + x, 0.02 * std::cos(2 * t), 0.01 * t);
  for (const double q : {std::cos(0.1 * x), 0.0, 0.0, std::sin(0.1 * x)})
    r.add_handle_quaternion_m(static_cast<float>(q));
  const double error = run.touching(tick) ? run.force_error_contact_n : run.force_error_free_n;
  synthetic::set3(r.mutable_environment_force_g_n(), -f, 0, 0);
  synthetic::set3(r.mutable_environment_torque_g_nm(), 0, 0, 0);
  synthetic::set3(r.mutable_user_force_g_n(), -f, error, 0);
  synthetic::set3(r.mutable_user_torque_g_nm(), 0, 0.01, 0);
  r.set_user_estimated(run.user_estimated);
  if (run.coupling_n > 0) synthetic::set3(r.mutable_coupling_force_g_n(), 0, run.coupling_n, 0);
  synthetic::set3(r.mutable_force_g_n(), f, 0, 0);
  synthetic::set3(r.mutable_torque_g_nm(), 0, 0, 0);
  r.set_age_s(0.0003f);
  r.set_limits(tick == 1500 ? 2u : 0u);
  r.set_clock_offset_ns(clock_offset_ns);
  synthetic::add_costs(r, tick);
  return r;
}

inline record::SlaveRecord slave_record(const SyntheticRun& run, std::int64_t tick) {
  const double t = static_cast<double>(tick) * 1e-3, x = 0.03 * std::sin(4 * t);
  const double error = run.touching(tick) ? run.tracking_contact_m : run.tracking_free_m;
  record::SlaveRecord r;
  r.set_reading_ok(true);
  r.set_mode(tick < 10 ? record::MODE_READY : record::MODE_ENGAGED);
  r.set_coupled(tick >= 10);
  synthetic::set3(r.mutable_robot_position_s_m(), 0.02 * std::cos(2 * t), 0.326 - x, 0.389);
  synthetic::set3(r.mutable_target_position_s_m(), 0.02 * std::cos(2 * t), 0.326 - x,
                  0.389 + error);
  for (const float q : {0.8f, 0.6f, 0.0f, 0.0f}) {
    r.add_robot_quaternion_s(q);
    r.add_target_quaternion_s(q);
  }
  synthetic::set3(r.mutable_robot_velocity_s_m_per_s(), 0, 0, 0.01);
  synthetic::set3(r.mutable_robot_angular_velocity_s_rad_per_s(), 0, 0, 0);
  synthetic::set3(r.mutable_contact_force_s_n(), 0, 0, run.touching(tick) ? run.contact_n : 0);
  synthetic::set3(r.mutable_contact_torque_s_nm(), 0, 0, 0);
  if (run.boundary_n > 0) synthetic::set3(r.mutable_boundary_force_s_n(), run.boundary_n, 0, 0);
  for (int i = 0; i < 6; ++i) {
    r.add_q_rad(0.2 * i + 0.1 * std::sin(3 * t + i));
    r.add_q_command_rad(static_cast<float>(0.2 * i + 0.1 * std::sin(3 * t + i + 0.05)));
    r.add_tau_nm(static_cast<float>(5 * std::sin(7 * t + i)));
  }
  r.set_age_s(0.0002f);
  synthetic::add_costs(r, tick);
  return r;
}

inline RunData synthetic_master(const SyntheticRun& run, std::int64_t clock_offset_ns = 0) {
  MasterColumns columns;
  for (std::int64_t i = 0; i < run.ticks; ++i)
    columns.add(run.master_time(i), master_record(run, i, clock_offset_ns));
  RunData out{.files = {"master.mcap"}, .role = "master", .scene_hash = "1"};
  out.master = columns.take();
  return out;
}

// Log times as a slave writes them whose monotonic clock is `clock_offset_ns` ahead of the master's
// and whose epoch_minus_monotonic_ns is `epoch_ns` more than the master's 0.
inline RunData synthetic_slave(const SyntheticRun& run, std::int64_t clock_offset_ns = 0,
                               std::int64_t epoch_ns = 0) {
  SlaveColumns columns;
  for (std::int64_t i = 0; i < run.ticks; ++i)
    columns.add(run.master_time(i) + clock_offset_ns + epoch_ns, slave_record(run, i));
  RunData out{.files = {"slave.mcap"}, .role = "slave", .scene_hash = "1"};
  out.epoch_minus_monotonic_ns = epoch_ns;
  out.slave = columns.take();
  return out;
}

inline RunData synthetic_loopback(const SyntheticRun& run) {
  RunData out = synthetic_master(run);
  out.role = "loopback";
  out.slave = synthetic_slave(run).slave;
  out.metadata["limits"] = {{"1", "force"}, {"2", "slew"}};
  return out;
}

// Both sides in one file.
inline void write_synthetic(const SyntheticRun& run, const std::string& path,
                            const std::string& scene_text) {
  McapWriter file(path, "synthetic");
  file.add_metadata("farhand", {{"role", "loopback"}, {"scene_path", "made/up.textproto"}});
  file.add_attachment("scene.textproto", "text/plain", scene_text);
  const auto channel = [&](const char* topic, const char* schema) {
    return file.add_channel(topic, file.add_schema(schema, "protobuf", ""), "protobuf");
  };
  const std::uint16_t master = channel("/master", "farhand.record.MasterRecord");
  const std::uint16_t slave = channel("/slave", "farhand.record.SlaveRecord");
  for (std::int64_t i = 0; i < run.ticks; ++i) {
    const auto at = static_cast<std::uint64_t>(run.master_time(i));
    file.write(master, at, master_record(run, i).SerializeAsString());
    file.write(slave, at, slave_record(run, i).SerializeAsString());
  }
  file.close();
}

}  // namespace farhand
