// The master's tick, in two halves: sample() when the period begins, actuate() when the slave's
// answer to it is there or a cut-off has passed. So motion becomes force within one round trip.
// Plain functions of (now, partner, reading, state); the shell around them owns the clock, the
// socket and the device.
#pragma once

#include <optional>

#include "common/alignment.hpp"
#include "common/joint_continuity.hpp"
#include "common/limits.hpp"
#include "common/mode.hpp"
#include "common/peer.hpp"
#include "common/time.hpp"
#include "common/wire.hpp"
#include "master/ahrs/grip_motion.hpp"
#include "master/compensation.hpp"
#include "master/compensation/compensated_force.hpp"
#include "master/force_controller.hpp"
#include "master/force_sensing.hpp"
#include "master/guidance.hpp"
#include "master/handle.hpp"
#include "master/haptic_device.hpp"
#include "master/position_control.hpp"
#include "master/robot_coupling.hpp"

namespace farhand {

struct ForceFeedbackConfig {
  CompensationConfig compensation;
  ForceControllerConfig controller;
};

struct MasterConfig {
  double Ts = 0.001;                               // period of the tick [s]
  Duration stale = std::chrono::milliseconds(20);  // no answer for so long ends the engagement
  Handle handle;
  std::optional<double> alignment;  // [rad] of the handle, within which it may be coupled again
  double velocity_cutoff_hz = 60;
  std::optional<GripMotionConfig> grip_motion;  // of an AHRS on a Falcon's grip
  double max_motor_torque = 3;                  // [N m]
  double torque_rise_time_s =
      0.02;  // a motor torque may go from 0 to its limit in this time: the slew limit
  std::optional<HandleForceSensingConfig> force_sensing;  // twin delta only
  std::optional<ForceFeedbackConfig> force_feedback;
  bool reflects_contact = true;                       // the slave's contact wrench is felt
  std::optional<CompensatedForceConfig> compensated;  // instead of the contact wrench
  std::optional<RobotCouplingConfig> robot_coupling;  // the robot's position is felt, too
  bool sends_user_wrench = false;
  std::optional<PositionControlConfig> position_control;
  std::optional<GuidanceConfig> guidance;  // felt through force_feedback
};

// Everything one tick read, sent, received and wrote; the recorder takes it whole.
struct MasterTick {
  TimePoint now{};
  HandleReading reading;
  HandlePose handle;  // with an AHRS its orientation is the AHRS'
  bool has_ahrs = false;
  AhrsState ahrs = AhrsState::absent;
  double tilt_sigma = 0, yaw_sigma = 0;  // [rad] standard deviations of that orientation
  bool user_felt = false;                // F_user_G is this tick's, from the sensors
  bool user_estimated = false;           // F_user_G is the estimate of a handle without sensors
  Wrench F_user_G;  // user on handle in handle axes, bias and the grip's weight removed
  Mode mode = Mode::disconnected;
  Reason reason = Reason::no_partner;
  bool aligned = true;         // as Alignment says, and the slave's; without it always
  Vec3 turn_M = Vec3::Zero();  // as Alignment says
  MasterToSlave out;
  Duration age = Duration::max();        // of the slave's message acted upon; max before the first
  Mode slave_mode = Mode::disconnected;  // as that message says, and
  Reason slave_reason = Reason::no_partner;
  bool coupled = false;                 // whether the robot follows the handle
  const char* method_reason = nullptr;  // for out.method; nullptr where the scene named it
  Wrench F_env_G;                       // robot on environment in handle axes, as compensated;
                                        // guidance against it
  Wrench F_coupling_G;                  // the share of the coupling to the robot's pose in it
  Wrench F_G;                           // commanded: handle on hand
  Vec6 tau = Vec6::Zero();              // written to the device [N m]
  bool position_controlled = false;
  Vec3 p_MH_target = Vec3::Zero();  // of position control
  LimitSet limits = kLimitNone;
};

// Whether the slave's contact wrench is of use.
bool wants_force(const MasterConfig& config) noexcept;

class Master {
 public:
  explicit Master(const MasterConfig& config);

  // Where the handle is, and what the slave shall know of it. Send the message at once.
  const MasterToSlave& sample(TimePoint now, const HandleReading& reading,
                              const Peer<SlaveToMaster>& slave) noexcept;

  // Motor torques for this period. Write tick.tau. The reference stays valid until the next
  // sample(). danger_M, for the danger cue of position control: towards a danger, length from 0,
  // none, to 1, at its nearest; added to what the robot presses on, if the cue listens to that.
  const MasterTick& actuate(TimePoint now, const Peer<SlaveToMaster>& slave,
                            const Vec3& danger_M = Vec3::Zero()) noexcept;

  // From now on position control parks the grip, as if the clutch were held; it leaves no fault.
  void park() noexcept { park_ = true; }
  // From the next sample on STOPPED, and every force lets go.
  void stop() noexcept { stop_ = true; }

  const MasterConfig& config() const noexcept { return config_; }

 private:
  void place_handle() noexcept;
  void move_grip() noexcept;
  Equipment equipment() const noexcept;
  void decide_mode(const Peer<SlaveToMaster>& slave) noexcept;
  bool aligned(const SlaveToMaster& in) noexcept;
  bool usable() const noexcept;
  void count_presses() noexcept;
  void sense_force() noexcept;
  void tell_coupling() noexcept;
  void tell_user() noexcept;
  Wrench environment(const Peer<SlaveToMaster>& slave, double share) noexcept;
  Vec3 pressed_on(const Peer<SlaveToMaster>& slave) const noexcept;
  Wrench drive_to_target(TimePoint now, const Vec3& danger_M) noexcept;
  Wrench wanted_wrench(const Peer<SlaveToMaster>& slave) noexcept;

  MasterConfig config_;
  Handle handle_;
  HandleVelocity velocity_;
  // At 20 rad/s the arm's end is as fast as a hand, 2 m/s.
  JointContinuity continuity_{Vec6::Constant(20)};
  std::optional<GripMotion> grip_motion_;  // in its place
  Equipment when_placed_ = Equipment::ok;  // if the kinematics know where it is
  std::optional<HandleForceSensing> force_sensing_;
  std::optional<ForceController> force_;
  std::optional<PositionControl> position_;
  std::optional<CompensatedForce> compensated_;
  std::optional<Alignment> alignment_;
  bool maps_forces_ = false;  // some stage needs the map between wrenches and motors
  Status forces_ = Status::not_finite;
  Wrench F_given_G_;  // of the motors' torques written last
  ModeState state_;
  bool stop_ = false;
  bool park_ = false;
  MasterTick tick_;
};

}  // namespace farhand
