// The smallest scene's ticks written as straight lines: the same functions in the same order on the
// same values, without Master, Slave, or any stage that may be absent. What composition costs is
// measured against them (tests/loop/instructions.sh). kRecorded: they leave the same record behind
// (all but fields that the smallest scene never writes); otherwise only the message and torques.
#pragma once

#include <array>

#include "master/master.hpp"
#include "slave/slave.hpp"

namespace farhand {

// Twin delta, no force.
template <bool kRecorded>
struct StraightMaster {
  explicit StraightMaster(const MasterConfig& config);
  const MasterTick& tick(TimePoint now, const HandleReading& reading,
                         const Peer<SlaveToMaster>& slave) noexcept;

  TwinDeltaGeometry geometry;
  Duration stale;
  HandleVelocity velocity;
  ModeState mode_state;
  bool was_read = false;
  Vec6 theta_read = Vec6::Zero();
  TimePoint read_at{};
  MasterTick record;
};

// No force sensor, no feed-forward.
template <bool kRecorded>
struct StraightSlave {
  explicit StraightSlave(const SlaveConfig& config);
  const SlaveTick& tick(TimePoint now, const Peer<MasterToSlave>& master,
                        const RobotReading& robot) noexcept;

  ArmGeometry arm;
  JointLimits joints;
  WorkspaceConfig workspace;
  Duration stale;
  Vec6 q_step, tau_max, tau_step, max_drive, drive_step;
  double braking;
  Vec6 drive = Vec6::Zero();
  std::array<Pid, 6> pid;
  std::array<PidState, 6> state{};
  ModeState mode_state;
  std::uint32_t clutch_presses = 0;
  WorkspaceState target;
  bool started = false, was_read = false;
  Vec6 q_read = Vec6::Zero();
  TimePoint read_at{};
  Vec6 q_target = Vec6::Zero();
  SlaveTick record;
};

}  // namespace farhand
