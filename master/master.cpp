#include "master/master.hpp"

namespace farhand {

bool wants_force(const MasterConfig& config) noexcept {
  const auto& position = config.position_control;
  return config.force_feedback ||
         (position && position->danger_cue && position->danger_cue->contact > 0);
}

Master::Master(const MasterConfig& config)
    : config_(config), handle_(config.handle), velocity_(config.velocity_cutoff_hz, config.Ts) {
  if (config.grip_motion) grip_motion_.emplace(*config.grip_motion);
  if (config.force_sensing) force_sensing_.emplace(*config.force_sensing);
  if (config.force_feedback) force_.emplace(config.force_feedback->controller, config.Ts);
  if (config.compensated) compensated_.emplace(*config.compensated);
  if (config.alignment) alignment_.emplace(*config.alignment);
  if (config.position_control) position_.emplace(*config.position_control, config.Ts);
  maps_forces_ = force_sensing_ || force_ || position_;
  tick_.out.force_wanted = wants_force(config);
  tick_.user_estimated = force_ && force_->user_estimate() != nullptr;
  tick_.position_controlled = position_.has_value();
  tick_.has_ahrs = grip_motion_.has_value();
}

// Called once, by sample(), and so a part of it: calls would cost more than absent stages may.
//
// An arm that leaps is no reading.
[[gnu::always_inline]] inline void Master::place_handle() noexcept {
  using Is = JointContinuity::Verdict;
  const Vec6& theta = tick_.reading.theta;
  const Is is = continuity_.step(tick_.now, theta);
  if (is == Is::elsewhere) velocity_.restart();
  if (is != Is::leapt) return update(handle_, theta, tick_.handle);
  tick_.handle.status = Status::not_finite;
}

Equipment Master::equipment() const noexcept {
  const Status is = tick_.handle.status;
  if (!tick_.reading.ok) return Equipment::silent;
  if (is == Status::ok) return when_placed_;
  return is == Status::not_finite ? Equipment::implausible : Equipment::outside;
}

[[gnu::always_inline]] inline void Master::decide_mode(const Peer<SlaveToMaster>& slave) noexcept {
  const HandleReading& reading = tick_.reading;
  const Mode other = slave.newest != nullptr ? slave.newest->mode : Mode::disconnected;
  state_ = next_mode(state_,
                     {.equipment = equipment(),
                      .connected = slave.connected && slave.newest != nullptr,
                      .synced = slave.synced,
                      .fresh = slave.age <= config_.stale,
                      .partner = partner(other),
                      .dead_man = reading.dead_man,
                      .aligned = !alignment_ || slave.newest == nullptr || aligned(*slave.newest),
                      .reset = reading.clutch && !tick_.out.clutch && !reading.dead_man,
                      .stop = stop_},
                     tick_.now);
  tick_.mode = state_.mode;
  tick_.reason = state_.reason;
}

const MasterToSlave& Master::sample(TimePoint now, const HandleReading& reading,
                                    const Peer<SlaveToMaster>& slave) noexcept {
  tick_.now = now;
  tick_.reading = reading;
  tick_.limits = kLimitNone;
  if (reading.ok) place_handle();
  if (grip_motion_)
    move_grip();
  else
    tick_.out.V_MH = velocity_.step(tick_.handle.X_MH);
  decide_mode(slave);
  if (maps_forces_) sense_force();
  count_presses();
  MasterToSlave& out = tick_.out;
  out.p_MH = tick_.handle.X_MH.p;
  out.q_MH = to_quat(tick_.handle.X_MH.R);
  out.mode = tick_.mode;
  out.reason = tick_.reason;
  if (compensated_) tell_coupling();
  if (config_.sends_user_wrench) tell_user();
  return out;
}

void Master::tell_coupling() noexcept {
  compensated_->tell(tick_.out);
  if (const auto* choice = compensated_->choice()) tick_.method_reason = choice->reason;
}

void Master::tell_user() noexcept {
  MasterToSlave& out = tick_.out;
  out.has_user_wrench = tick_.user_felt;
  if (out.has_user_wrench) out.F_user_M = tick_.handle.R_MG * tick_.F_user_G;
}

// Where the grip is, the encoders say: forces and guides are those of their kinematics.
void Master::move_grip() noexcept {
  HandlePose& handle = tick_.handle;
  const bool placed = tick_.reading.ok && handle.status == Status::ok;
  if (tick_.reading.ahrs) grip_motion_->take(*tick_.reading.ahrs, tick_.now);
  const GripMotionEstimate& e = grip_motion_->step(tick_.now, placed ? &handle.X_MH.p : nullptr);
  handle.X_MH.R = e.X_MH.R;
  tick_.out.V_MH = e.V_MH;
  tick_.ahrs = e.ahrs;
  const bool oriented = e.ahrs == AhrsState::ok || e.ahrs == AhrsState::lost;
  when_placed_ = oriented ? Equipment::ok : Equipment::unoriented;
  tick_.tilt_sigma = e.tilt_sigma;
  tick_.yaw_sigma = e.yaw_sigma;
}

void Master::sense_force() noexcept {
  const bool read = usable();
  forces_ = read ? map_forces(handle_, tick_.handle) : Status::not_finite;
  tick_.user_felt = force_sensing_ && read && tick_.reading.has_force;
  if (!tick_.user_felt) return;
  const TwinDeltaJacobian& J = std::get_if<TwinDeltaHandle>(&handle_)->J;
  tick_.user_felt = J.status == Status::ok;
  tick_.F_user_G = force_sensing_->step(tick_.reading.ends, J);
}

// Once engaged it is judged when the clutch is let go; else the slave, which knows what is coupled
// by now, has the word. So it has until its answer knows of every press of the clutch: an older one
// may know an older orientation.
bool Master::aligned(const SlaveToMaster& in) noexcept {
  const bool slave_agrees = in.reason != Reason::turn_handle;
  const bool knows = in.clutch_presses_seen == tick_.out.clutch_presses;
  const bool parallel = alignment_->step(in, to_quat(tick_.handle.X_MH.R));
  tick_.aligned = (parallel || !knows) && slave_agrees;
  tick_.turn_M = alignment_->turn();
  const bool unclutched = tick_.out.clutch && !tick_.reading.clutch;
  return tick_.mode == Mode::engaged && !unclutched ? slave_agrees : tick_.aligned;
}

// The handle is known, and forces may be made on it.
bool Master::usable() const noexcept {
  return tick_.reading.ok && tick_.handle.status == Status::ok && tick_.mode != Mode::fault &&
         tick_.mode != Mode::stopped;
}

// Edges are counted so that the slave can tell a new press from one it missed the release of.
void Master::count_presses() noexcept {
  MasterToSlave& out = tick_.out;
  if (tick_.reading.dead_man && !out.dead_man) ++out.dead_man_presses;
  if (tick_.reading.clutch && !out.clutch) ++out.clutch_presses;
  out.dead_man = tick_.reading.dead_man;
  out.clutch = tick_.reading.clutch;
}

const MasterTick& Master::actuate(TimePoint now, const Peer<SlaveToMaster>& slave,
                                  const Vec3& danger_M) noexcept {
  tick_.age = slave.age;
  if (slave.newest != nullptr) {
    if (compensated_) compensated_->hear(slave, now);
    tick_.slave_mode = slave.newest->mode;
    tick_.slave_reason = slave.newest->reason;
    tick_.coupled = slave.newest->coupled;
  }
  if (!force_ && !position_) return tick_;

  Vec6 tau = Vec6::Zero();
  tick_.F_G = position_ ? drive_to_target(now, danger_M + pressed_on(slave)) : wanted_wrench(slave);
  if (forces_ == Status::ok) {
    tau = torque(handle_, tick_.F_G);
  } else if (usable()) {
    tick_.limits |= kLimitAcceptance;
    if (force_) force_->let_go();
    if (position_) position_->let_go();
  }
  if (forces_ != Status::ok && compensated_) compensated_->let_go();
  tick_.tau = limit_motor_torques(
      config_.max_motor_torque, config_.max_motor_torque * config_.Ts / config_.torque_rise_time_s,
      tau, tick_.tau, tick_.limits);
  if (force_ && force_->closes()) F_given_G_ = wrench(handle_, tick_.tau);
  return tick_;
}

// What of the slave's side is felt, by the bilateral architecture.
Wrench Master::environment(const Peer<SlaveToMaster>& slave, double share) noexcept {
  const SlaveToMaster& in = *slave.newest;
  if (compensated_)
    return compensated_->step({.handle = tick_.handle,
                               .V_MH = tick_.out.V_MH,
                               .robot = in,
                               .echo_age = slave.echo_age,
                               .share = share,
                               .now = tick_.now});
  Wrench F_G;
  if (config_.reflects_contact) F_G = tick_.handle.R_MG.transpose() * in.F_E_M;
  if (config_.robot_coupling) {
    const Wrench F = couple(*config_.robot_coupling, tick_.handle, tick_.out.V_MH, in);
    tick_.F_coupling_G = share * F;
    F_G = F_G + F;
  }
  return share * F_G;
}

// As a danger of the cue: faded by its age as a felt force is, and none over a stale link.
Vec3 Master::pressed_on(const Peer<SlaveToMaster>& slave) const noexcept {
  const auto& cue = config_.position_control->danger_cue;
  if (!cue || !(cue->contact > 0)) return Vec3::Zero();
  if (slave.newest == nullptr || !slave.connected || slave.age > config_.stale) return Vec3::Zero();
  return fade(CompensationConfig{}, slave.age) *
         clamp_norm(Vec3(slave.newest->F_E_M.force / cue->contact), 1);
}

Wrench Master::drive_to_target(TimePoint now, const Vec3& danger_M) noexcept {
  Wrench F;
  if (usable())
    F.force = position_->step(now,
                              {.p_MH = tick_.handle.X_MH.p,
                               .v_MH = tick_.out.V_MH.linear,
                               .park = tick_.reading.clutch || park_,
                               .danger_M = danger_M},
                              tick_.limits);
  tick_.p_MH_target = position_->target();
  return F;
}

// In handle axes, already within what the hand may feel.
Wrench Master::wanted_wrench(const Peer<SlaveToMaster>& slave) noexcept {
  // Holding because the link aged: the last wrench fades by its age instead of breaking off.
  const bool in_touch = tick_.mode == Mode::engaged || tick_.mode == Mode::holding;
  const bool felt = in_touch && slave.newest != nullptr && slave.newest->coupled;
  const CompensationConfig& fading = compensated_ && !compensated_->reflects()
                                         ? kSpringFade
                                         : config_.force_feedback->compensation;
  const double share = felt ? fade(fading, slave.age) : 0;
  if (felt && share < 1) tick_.limits |= kLimitStale;
  if (config_.robot_coupling) tick_.F_coupling_G = {};
  tick_.F_env_G = felt ? environment(slave, share) : Wrench{};
  if (compensated_ && !felt) compensated_->let_go();
  if (config_.guidance && tick_.mode == Mode::engaged)
    tick_.F_env_G = tick_.F_env_G - guide(*config_.guidance, handle_, tick_.handle, tick_.out.V_MH);
  const Wrench F_G = force_->step({.F_env_G = tick_.F_env_G,
                                   .felt = share == 1,
                                   .F_user_G = tick_.user_felt ? &tick_.F_user_G : nullptr,
                                   .handle = usable() ? &tick_.handle : nullptr,
                                   .F_given_G = F_given_G_,
                                   .engaged = tick_.mode == Mode::engaged},
                                  tick_.limits);
  if (force_->user_estimate() != nullptr) tick_.F_user_G = *force_->user_estimate();
  return F_G;
}

}  // namespace farhand
