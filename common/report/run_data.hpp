// A recorded run as columns, in the units of the record: what the report's figures and charts are
// computed from. NaN where a value was absent.
#pragma once

#include <array>
#include <cstdint>
#include <limits>
#include <map>
#include <optional>
#include <string>
#include <vector>

#include "common/geometry.hpp"
#include "proto/record.pb.h"

namespace farhand {

using Column = std::vector<float>;
template <std::size_t N>
using Columns = std::array<Column, N>;

// Link counters at the last tick, counts since the program's start.
struct LinkTotals {
  std::uint64_t received = 0, dropped = 0, lost = 0, reordered = 0, not_sent = 0;
};

inline constexpr std::array kStageNames = {"woken late", "read", "compute", "link", "write"};

// What both sides record alike.
struct SideData {
  std::int64_t start_ns = 0;  // log time of the first tick
  std::vector<double> t;      // [s] since the start of the run
  std::vector<std::uint8_t> mode, coupled;
  std::vector<std::uint32_t> limits;
  Column age;                          // [s]
  Column round_trip;                   // [us]
  Columns<kStageNames.size()> stages;  // [us]
  Column busy;                         // [us], sum of all stages but waiting
  Column work;  // [J], port energy since the start, see MasterData and SlaveData
  std::uint64_t overruns = 0;
  double overrun_own_us = 0, overrun_machine_us = 0;
  LinkTotals link;
  std::vector<std::int64_t> clock_offset_ns;  // at ticks with a known round trip

  std::size_t size() const noexcept { return t.size(); }
};

// Work: of the motors on the hand, sum of tau times the motor angle gained until the next tick. A
// torque is held for its tick, so this is exact, and equals commanded wrench times handle velocity
// (virtual work, tau = J^T F) without a differentiated signal.
struct MasterData : SideData {
  Columns<3> position;  // p_MH [m]
  Columns<3> turn;      // of the handle since the first tick: rotation vector, M axes [rad]
  Columns<3> user_force, user_torque;                // user on handle, G axes [N], [N m]
  bool user_estimated = false;                       // by a model, not measured
  Columns<3> coupling_force, coupling_torque;        // of environment_*, of the robot's pose
  Columns<3> environment_force, environment_torque;  // robot on environment, G axes
  Columns<3> force, torque;                          // commanded: handle on hand, G axes
  Columns<3> target;                                 // of position control, M axes [m]
  Columns<6> tau;                                    // [N m]
  bool position_controlled = false;
};

// Work: contact force and torque times the tool's velocity, the robot's on the environment,
// integrated by the trapezoidal rule.
struct SlaveData : SideData {
  Columns<3> position, target;               // of the tool, S axes [m]
  Columns<3> turn, target_turn;              // since the first tick: rotation vectors, S axes [rad]
  Columns<3> contact_force, contact_torque;  // robot on environment, S axes
  Columns<3> boundary_force, boundary_torque;  // the same of the boundary
  Columns<6> q, q_command, tau;                // [rad], [N m]
  Column position_error;                       // |target - tool| while coupled [m]
  Column rotation_error;                       // angle between both while coupled [rad]
};

using Metadata = std::map<std::string, std::map<std::string, std::string>>;

struct RunData {
  std::vector<std::string> files;
  std::string role;  // master, slave, loopback
  std::string scene_hash, scene_path, scene_text;
  std::int64_t epoch_minus_monotonic_ns = 0;
  Metadata metadata;
  std::vector<std::string> notes;  // what a reader must know: cut off, damaged
  std::optional<MasterData> master;
  std::optional<SlaveData> slave;

  double duration() const noexcept;        // [s]
  std::int64_t start_ns() const noexcept;  // log time of the run's first tick
};

// Appends one tick after another. log_time_ns ascends.
class MasterColumns {
 public:
  void add(std::int64_t log_time_ns, const record::MasterRecord& r);
  MasterData take() { return std::move(data_); }

 private:
  MasterData data_;
  Mat3 R_first_ = Mat3::Zero();  // zero before the first orientation
  std::array<double, 6> theta_{};
  std::array<double, 6> tau_{};
  double work_ = 0;
};

class SlaveColumns {
 public:
  void add(std::int64_t log_time_ns, const record::SlaveRecord& r);
  SlaveData take() { return std::move(data_); }

 private:
  void add_poses(const record::SlaveRecord& r);
  void add_work(double dt, const record::SlaveRecord& r);

  SlaveData data_;
  Mat3 R_first_ = Mat3::Zero();
  double power_ = 0;
  double work_ = 0;
};

}  // namespace farhand
