#include "tests/loop/straight_ticks.hpp"

#include <algorithm>
#include <numbers>

namespace farhand {

namespace {

bool near(const Vec6& q, const Vec6& last) {
  for (int i = 0; i < 6; ++i)
    if (!(std::abs(q[i] - last[i]) <= 0.05)) return false;
  return true;
}
double since(TimePoint then, TimePoint now) {
  return seconds(std::clamp(now - then, Duration::zero(), Duration(std::chrono::milliseconds(50))));
}

}  // namespace

template <bool kRecorded>
StraightMaster<kRecorded>::StraightMaster(const MasterConfig& config)
    : geometry(std::get<TwinDeltaHandle>(config.handle).geometry),
      stale(config.stale),
      velocity(config.velocity_cutoff_hz, config.Ts) {}

template <bool kRecorded>
const MasterTick& StraightMaster<kRecorded>::tick(TimePoint now, const HandleReading& reading,
                                                  const Peer<SlaveToMaster>& slave) noexcept {
  MasterToSlave& out = record.out;
  HandlePose& handle = record.handle;
  if (!reading.ok) return record;
  if (was_read && !near(reading.theta, theta_read) &&
      (reading.theta - theta_read).cwiseAbs().maxCoeff() > 0.05 + 2 * since(read_at, now) * 20)
    return record;
  theta_read = reading.theta, read_at = now, was_read = true;
  const TwinDeltaForward at = forward(geometry, reading.theta);
  if (at.status != Status::ok) return record;
  handle.R_MG = handle_axes(at.pose.axis, handle.R_MG.col(0));
  handle.twist = twist_angle(geometry, at.pose.length);
  handle.X_MH.R = handle_rotation(geometry, handle.R_MG, at.pose.length);
  handle.X_MH.p = at.pose.p_MH;

  const Mode other = slave.newest != nullptr ? slave.newest->mode : Mode::disconnected;
  mode_state = next_mode(mode_state,
                         {.equipment = Equipment::ok,
                          .connected = slave.connected && slave.newest != nullptr,
                          .synced = slave.synced,
                          .fresh = slave.age <= stale,
                          .partner = partner(other),
                          .dead_man = reading.dead_man,
                          .reset = reading.clutch && !out.clutch && !reading.dead_man},
                         now);
  out.mode = mode_state.mode;
  out.reason = mode_state.reason;
  if (reading.dead_man && !out.dead_man) ++out.dead_man_presses;
  if (reading.clutch && !out.clutch) ++out.clutch_presses;
  out.dead_man = reading.dead_man;
  out.clutch = reading.clutch;
  out.p_MH = handle.X_MH.p;
  out.q_MH = to_quat(handle.X_MH.R);
  out.V_MH = velocity.step(handle.X_MH);
  if constexpr (kRecorded) {
    record.now = now;
    record.reading = reading;
    handle.status = at.status;
    record.mode = out.mode;
    record.reason = out.reason;
    if (slave.newest != nullptr) {
      record.slave_mode = slave.newest->mode;
      record.slave_reason = slave.newest->reason;
      record.coupled = slave.newest->coupled;
    }
    record.age = slave.age;
    record.limits = kLimitNone;
  }
  return record;
}

template <bool kRecorded>
StraightSlave<kRecorded>::StraightSlave(const SlaveConfig& config)
    : arm(config.arm),
      joints(config.joints),
      workspace(config.workspace),
      stale(config.stale),
      q_step(config.joints.speed * config.Ts) {
  for (int i = 0; i < 6; ++i) {
    tau_max[i] = config.model.links[i].torque_limit;
    const PidConfig gains = joint_gains(config.servo, config.servo.inertia[i], tau_max[i]);
    pid[i] = make_pid(gains, config.Ts);
    max_drive[i] = gains.kd * 0.95 * joints.speed[i];
  }
  drive_step = max_drive * (config.Ts / 0.05);
  braking = 2 * std::numbers::pi * config.servo.bandwidth_hz / 3 * config.Ts;
  tau_step = tau_max * (config.Ts / config.torque_rise_time_s);
}

template <bool kRecorded>
const SlaveTick& StraightSlave<kRecorded>::tick(TimePoint now, const Peer<MasterToSlave>& master,
                                                const RobotReading& robot) noexcept {
  SlaveToMaster& out = record.out;
  Vec6& q_cmd = record.q_cmd;
  if (!robot.ok) return record;
  LimitSet limits = kLimitNone;
  const MasterToSlave* in = master.newest;
  const bool clutched = in != nullptr && in->clutch_presses > clutch_presses;
  if (in != nullptr) clutch_presses = in->clutch_presses;
  mode_state = next_mode(
      mode_state,
      {.equipment = Equipment::ok,
       .connected = master.connected && in != nullptr,
       .synced = master.synced,
       .fresh = master.age <= stale,
       .partner = in != nullptr && in->mode == Mode::stopped ? Partner::stopped : Partner::able,
       .dead_man = in != nullptr && in->dead_man && in->mode == Mode::engaged,
       .reset = clutched && !in->dead_man},
      now);
  out.mode = mode_state.mode;
  out.reason = mode_state.reason;
  if (master.age > stale) limits |= kLimitStale;

  if (!plausible(robot)) return record;
  if (was_read && !near(robot.q, q_read) &&
      ((robot.q - q_read).cwiseAbs() - 2 * since(read_at, now) * joints.speed).maxCoeff() > 0.05)
    return record;
  q_read = robot.q, read_at = now, was_read = true;
  const ArmKinematics at = kinematics(arm, robot.q);
  out.V_SE = tool_twist(at.J, robot.dq);
  if (!started) {
    started = true;
    q_cmd = q_target = robot.q;
    uncouple(target, at.X_SE);
  }
  out.coupled = out.mode == Mode::engaged && !in->clutch;
  Status found = Status::ok;
  if (out.coupled) {
    const Pose X_MH{in->q_MH.toRotationMatrix(), in->p_MH};
    if (!target.coupled) couple(workspace, target, X_MH, forward(arm, q_cmd));
    Vec6 lag = q_cmd - q_target;
    lag.segment<2>(1).setZero();
    const ArmNearest nearest =
        inverse(arm, joints, follow(workspace, target, X_MH, limits), q_target + lag);
    found = nearest.status;
    if (found == Status::ok)
      q_target = nearest.q;
    else
      limits |= kLimitWorkspace;
  } else if (target.coupled) {
    q_target = q_cmd;
    uncouple(target, forward(arm, q_cmd));
  }

  const Vec6 move = q_target - q_cmd;
  const Vec6 up = (braking * (joints.upper - q_cmd)).cwiseMax(1e-6).cwiseMin(q_step);
  const Vec6 down = (braking * (joints.lower - q_cmd)).cwiseMin(-1e-6).cwiseMax(-q_step);
  const Vec6 allowed = move.cwiseMax(down).cwiseMin(up);
  if (allowed != move) limits |= kLimitSpeed;
  q_cmd = allowed == move ? q_target : Vec6(q_cmd + allowed);
  if ((robot.q - joints.upper).cwiseMax(joints.lower - robot.q).maxCoeff() > 0.002) {
    for (int i = 0; i < 6; ++i) {
      const bool above = robot.q[i] > joints.upper[i] + 0.002;
      const bool below = robot.q[i] < joints.lower[i] - 0.002;
      if ((above && state[i].I > 0) || (below && state[i].I < 0)) state[i].I = state[i].I_lost = 0;
    }
  }
  Vec6 wanted;
  bool held_back = false;
  for (int i = 0; i < 6; ++i) {
    const double wish = pid[i].kp * (q_cmd[i] - robot.q[i]), step_i = drive_step[i];
    held_back |= std::abs(wish) > max_drive[i];
    drive[i] = std::clamp(wish, std::max(drive[i] - step_i, -max_drive[i]),
                          std::min(drive[i] + step_i, max_drive[i]));
    const double I = state[i].I, I_lost = state[i].I_lost;
    wanted[i] = step(pid[i], state[i], q_cmd[i], robot.q[i], drive[i] - wish);
    if (drive[i] != wish) state[i].I = I, state[i].I_lost = I_lost;
  }
  if ((robot.dq.cwiseAbs() - joints.speed).maxCoeff() > 0) {
    for (int i = 0; i < 6; ++i) {
      if (std::abs(robot.dq[i]) <= joints.speed[i] || wanted[i] * robot.dq[i] <= 0) continue;
      wanted[i] = 0;
      limits |= kLimitSpeed;
    }
  }
  if (std::any_of(state.begin(), state.end(), [](const PidState& s) { return s.saturated; }))
    limits |= kLimitSaturated;
  if (held_back) limits |= kLimitSpeed;
  record.tau = limit_joint_torques(tau_max, tau_step, wanted, record.tau, limits);

  out.p_SE = at.X_SE.p;
  out.q_SE = to_quat(at.X_SE.R);
  out.limits = limits;
  if (in != nullptr) {
    out.dead_man_presses_seen = in->dead_man_presses;
    out.clutch_presses_seen = in->clutch_presses;
  }
  if constexpr (kRecorded) {
    record.now = now;
    record.age = master.age;
    record.robot = robot;
    record.mode = out.mode;
    record.reason = out.reason;
    record.coupled = out.coupled;
    record.X_SE = at.X_SE;
    record.X_SE_target = target.X_SE_target;
    record.inverse = found;
    record.singularity = at.singularity;
    record.limits = limits;
  }
  return record;
}

template struct StraightMaster<false>;
template struct StraightMaster<true>;
template struct StraightSlave<false>;
template struct StraightSlave<true>;

}  // namespace farhand
