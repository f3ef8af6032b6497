#include "slave/slave.hpp"

#include <algorithm>
#include <limits>
#include <numbers>
#include <utility>

namespace farhand {
namespace {

// A command that comes to rest as exp(-rate t), where a servo of damping ratio 0.9 whose velocity
// is fed forward through 12 Hz hardly overshoots it (0.002 rad): a third of its bandwidth. A limit
// met at 6.3 rad/s without that is overrun by 0.18 rad.
double braking_rate(const JointServoConfig& servo) noexcept {
  return 2 * std::numbers::pi * servo.bandwidth_hz / 3;
}

// What it may move by however near the limit is: an exponential alone never arrives [rad per tick].
constexpr double kLastStep = 1e-6;

}  // namespace

Wrench boundary_wrench(const WorkspaceConfig& workspace, const SlaveTick& tick) noexcept {
  return bring(workspace, tick.out.F_E_M - reflect(workspace, tick.F_E_S));
}

Slave::Slave(const SlaveConfig& config) noexcept
    : config_(config),
      q_step_(config.joints.speed * config.Ts),
      braking_(braking_rate(config.servo) * config.Ts),
      servo_(config.servo, config.model, config.joints, config.Ts),
      continuity_(config.joints.speed) {
  for (int i = 0; i < 6; ++i) tau_max_[i] = config.model.links[i].torque_limit;
  tau_step_ = tau_max_ * (config.Ts / config.torque_rise_time_s);
  if (config.force_sensing) force_sensing_.emplace(*config.force_sensing, config.Ts);
  if (config.compensated) compensated_.emplace(*config.compensated);
  if (config.deadband) deadband_.emplace(*config.deadband);
  if (config.admittance) admittance_.emplace(*config.admittance);
  if (config.workspace.alignment) alignment_.emplace(*config.workspace.alignment);
  if (config.boundary) boundary_.emplace(*config.boundary, config.arm, config.joints);
}

const SlaveTick& Slave::tick(TimePoint now, const Peer<MasterToSlave>& master,
                             const RobotReading& robot) noexcept {
  tick_.now = now;
  tick_.age = master.age;
  tick_.robot = robot;
  tick_.robot.ok = robot.ok && plausible(robot) && continues(robot);
  tick_.limits = kLimitNone;
  decide_mode(master, robot.ok);
  if (compensated_ && master.newest != nullptr) compensated_->hear(master, now);
  const bool was_found = std::exchange(found_, false);
  if (!tick_.robot.ok) {
    stay_blind();
    blind_ = blind_ || was_found;
  } else {
    const ArmKinematics arm = kinematics(config_.arm, robot.q);
    tick_.X_SE = arm.X_SE;
    tick_.singularity = arm.singularity;
    tick_.out.V_SE = tool_twist(arm.J, robot.dq);
    if (force_sensing_) tick_.F_E_S = force_sensing_->step(robot.F_E_S, arm.X_SE);
    if (blind_) find_again();
    move_target(master);
    command_joints(arm.J, master.newest);
  }
  answer(master.newest);
  return tick_;
}

// Where two readings agree that it is elsewhere, the robot is held where they find it.
bool Slave::continues(const RobotReading& robot) noexcept {
  const auto verdict = continuity_.step(tick_.now, robot.q);
  if (verdict == JointContinuity::Verdict::elsewhere) blind_ = true;
  return verdict != JointContinuity::Verdict::leapt;
}

// What the robot does is not known: nobody may feel or follow it.
void Slave::stay_blind() noexcept {
  tick_.coupled = false;
  tick_.out.V_SE = {};
  tick_.F_E_S = {};
  blind_ = blind_ || tick_.mode == Mode::fault;
}

// After a fault the robot may be anywhere: it is held where it is found, not driven back.
void Slave::find_again() noexcept {
  blind_ = started_ = false;
  servo_.reset();
}

namespace {

// Its operator, who holds nothing, is told to turn the handle.
bool asks_turn(const MasterToSlave& in) noexcept {
  return in.reason == Reason::turn_handle && !in.dead_man;
}

}  // namespace

void Slave::decide_mode(const Peer<MasterToSlave>& master, bool reads) noexcept {
  const MasterToSlave* in = master.newest;
  const bool clutched = in != nullptr && in->clutch_presses > clutch_presses_;
  clutch_presses_ = in != nullptr ? in->clutch_presses : kNoPressIsNew;
  if (turn_asked_ && clutched && asks_turn(*in)) forget_orientation(workspace_);
  state_ = next_mode(
      state_,
      {.equipment = tick_.robot.ok ? Equipment::ok
                    : reads        ? Equipment::implausible
                                   : Equipment::silent,
       .connected = master.connected && in != nullptr,
       .synced = master.synced,
       .fresh = master.age <= config_.stale,
       .partner = in != nullptr && in->mode == Mode::stopped ? Partner::stopped : Partner::able,
       .dead_man = in != nullptr && in->dead_man && in->mode == Mode::engaged,
       .aligned = !alignment_ || in == nullptr || aligned(*in),
       .reset = clutched && !in->dead_man,
       .stop = stop_},
      tick_.now);
  tick_.mode = state_.mode;
  tick_.reason = state_.reason;
  turn_asked_ = tick_.reason == Reason::turn_handle && in != nullptr && asks_turn(*in);
  if (master.age > config_.stale) tick_.limits |= kLimitStale;
}

// By what the master is told, but on our own judgement: with alignment no other handle is coupled.
// Under the clutch it may be turned away and back.
bool Slave::aligned(const MasterToSlave& in) noexcept {
  tick_.aligned = alignment_->step(tick_.out, in.q_MH);
  tick_.turn_M = alignment_->turn();
  return tick_.aligned || (in.clutch && tick_.mode == Mode::engaged);
}

void Slave::move_target(const Peer<MasterToSlave>& master) noexcept {
  if (!started_) {
    started_ = found_ = true;
    tick_.q_cmd = q_target_ = tick_.robot.q;
    forget_orientation(workspace_);
    uncouple(workspace_, tick_.X_SE);
    tick_.X_SE_target = tick_.X_SE;
  }
  tick_.coupled = tick_.mode == Mode::engaged && !master.newest->clutch;
  tick_.inverse = Status::ok;
  if (tick_.coupled) return follow_handle(master);
  if (boundary_) boundary_->relax();
  if (!workspace_.coupled) return;
  q_target_ = tick_.q_cmd;
  uncouple(workspace_, forward(config_.arm, tick_.q_cmd));
  tick_.X_SE_target = workspace_.X_SE_target;
}

void Slave::follow_handle(const Peer<MasterToSlave>& master) noexcept {
  const MasterToSlave& in = *master.newest;
  const Pose X_MH{in.q_MH.toRotationMatrix(), in.p_MH};
  if (!workspace_.coupled) {
    couple(config_.workspace, workspace_, X_MH, forward(config_.arm, tick_.q_cmd));
    if (boundary_) boundary_->couple(tick_.q_cmd);
    if (admittance_) admittance_->stop();
    if (compensated_) compensated_->start(X_MH, config_.workspace, workspace_);
    tick_.X_SE_target = workspace_.X_SE_target;
  }
  if (admittance_) return follow_push(in);
  if (compensated_) return follow_compensated(master);
  tick_.X_SE_target = follow(config_.workspace, workspace_, X_MH, tick_.limits);
  reach();
}

// A virtual mass goes where user and contact push it, and stops where the arm cannot follow.
void Slave::follow_push(const MasterToSlave& in) noexcept {
  const Pose last = tick_.X_SE_target;
  tick_.X_SE_target = admittance_->step(last, bring(config_.workspace, in.F_user_M), tick_.F_E_S,
                                        config_.workspace.rotation_lock);
  reach();
  if (tick_.inverse == Status::ok) return;
  tick_.X_SE_target = last;
  admittance_->stop();
}

// The target goes where the compensation says, and stops where the arm cannot follow.
void Slave::follow_compensated(const Peer<MasterToSlave>& master) noexcept {
  const Pose last = tick_.X_SE_target;
  const Pose X_MT =
      compensated_->step({.X_MT = as_handle(config_.workspace, workspace_, last),
                          .X_MR = as_handle(config_.workspace, workspace_, tick_.X_SE),
                          .V_MR = as_handle(config_.workspace, tick_.out.V_SE),
                          .F_E_M = reflect(config_.workspace, tick_.F_E_S),
                          .handle = *master.newest,
                          .age = master.age,
                          .echo_age = master.echo_age,
                          .now = tick_.now});
  workspace_.X_SE_target = last;
  tick_.X_SE_target = follow(config_.workspace, workspace_, X_MT, tick_.limits);
  reach();
  if (tick_.inverse != Status::ok) tick_.X_SE_target = last;
}

// The tool target becomes a joint target if it can be reached; otherwise the last one stays, or
// with a boundary slides along it. It continues the last one, but for joint 1 and the wrist what
// counts is where the command is: close by a singularity the target may turn them faster than they
// can follow, and there the other shoulder or wrist is right at once.
void Slave::reach() noexcept {
  Vec6 lag = tick_.q_cmd - q_target_;
  lag.segment<2>(1).setZero();
  if (boundary_) {
    const BoundaryHold hold = boundary_->step(tick_.X_SE_target, lag);
    tick_.inverse = hold.status;
    q_target_ = hold.q;
    tick_.X_SE_target = hold.X_SE;
    if (hold.held) tick_.limits |= kLimitWorkspace;
    return;
  }
  const ArmNearest nearest =
      inverse(config_.arm, config_.joints, tick_.X_SE_target, q_target_ + lag);
  tick_.inverse = nearest.status;
  if (nearest.status == Status::ok)
    q_target_ = nearest.q;
  else
    tick_.limits |= kLimitWorkspace;
}

// Speed limit on the joint command, lower where a joint limit is near, servo, and the way out:
// finite, clamp, slew.
void Slave::command_joints(const ArmJacobian& J, const MasterToSlave* in) noexcept {
  const Vec6 move = q_target_ - tick_.q_cmd;
  const Vec6 up =
      (braking_ * (config_.joints.upper - tick_.q_cmd)).cwiseMax(kLastStep).cwiseMin(q_step_);
  const Vec6 down =
      (braking_ * (config_.joints.lower - tick_.q_cmd)).cwiseMin(-kLastStep).cwiseMax(-q_step_);
  const Vec6 allowed = move.cwiseMax(down).cwiseMin(up);
  if (allowed != move) tick_.limits |= kLimitSpeed;
  tick_.q_cmd = allowed == move ? q_target_ : Vec6(tick_.q_cmd + allowed);

  Vec6 tau = servo_.step(tick_.q_cmd, tick_.robot.q);
  if (config_.user_force && tick_.coupled)
    tau += joint_torques(J, pushed(*config_.user_force, bring(config_.workspace, in->F_user_M)));
  slow_down(tau);
  if (servo_.saturated()) tick_.limits |= kLimitSaturated;
  if (servo_.held_back()) tick_.limits |= kLimitSpeed;
  tick_.tau = limit_joint_torques(tau_max_, tau_step_, tau, tick_.tau, tick_.limits);
}

// A joint beyond its largest speed, by what others do to it, is driven no further.
void Slave::slow_down(Vec6& tau) noexcept {
  const Vec6& dq = tick_.robot.dq;
  if ((dq.cwiseAbs() - config_.joints.speed).maxCoeff() <= 0) return;
  for (int i = 0; i < 6; ++i) {
    if (std::abs(dq[i]) <= config_.joints.speed[i] || tau[i] * dq[i] <= 0) continue;
    tau[i] = 0;
    tick_.limits |= kLimitSpeed;
  }
}

void Slave::answer(const MasterToSlave* in) noexcept {
  SlaveToMaster& out = tick_.out;
  out.p_SE = tick_.X_SE.p;
  out.q_SE = to_quat(tick_.X_SE.R);
  out.mode = tick_.mode;
  out.reason = tick_.reason;
  out.coupled = tick_.coupled;
  out.limits = tick_.limits;
  if (config_.sends_robot || alignment_) tell_where();
  if (compensated_) compensated_->tell(out);
  if (boundary_)
    out.F_E_M = reflect(config_.workspace, tick_.F_E_S + boundary_->F_E_S());
  else if (force_sensing_)
    out.F_E_M = reflect(config_.workspace, tick_.F_E_S);
  if (in != nullptr) {
    out.dead_man_presses_seen = in->dead_man_presses;
    out.clutch_presses_seen = in->clutch_presses;
  }
  if (deadband_) tick_.answers = deadband_->due(out, in != nullptr && in->force_wanted, tick_.now);
}

// Where the robot is, in the handle's terms. While it does not follow the handle these are but an
// orientation, and that only with alignment.
void Slave::tell_where() noexcept {
  SlaveToMaster& out = tick_.out;
  if (!tick_.coupled) {
    const std::optional<Mat3> R_MR = parallel_handle(config_.workspace, workspace_);
    out.has_robot = R_MR.has_value();
    out.p_MR.setZero();
    out.V_MR = {};
    if (R_MR) out.q_MR = to_quat(*R_MR);
    return;
  }
  out.has_robot = config_.sends_robot;
  if (!out.has_robot) return;
  const Pose X_MR = as_handle(config_.workspace, workspace_, tick_.X_SE);
  out.p_MR = X_MR.p;
  out.q_MR = to_quat(X_MR.R);
  out.V_MR = as_handle(config_.workspace, out.V_SE);
}

}  // namespace farhand
