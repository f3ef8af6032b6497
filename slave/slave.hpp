// The slave's tick: target in, joint torques and contact wrench out. A plain function of (now,
// partner, robot reading, state); the shell around it owns the clock, the socket and the robot.
#pragma once

#include <optional>

#include "common/alignment.hpp"
#include "common/joint_continuity.hpp"
#include "common/limits.hpp"
#include "common/mode.hpp"
#include "common/peer.hpp"
#include "common/time.hpp"
#include "common/wire.hpp"
#include "slave/answer_deadband.hpp"
#include "slave/arm.hpp"
#include "slave/boundary.hpp"
#include "slave/compensation/compensated_target.hpp"
#include "slave/force_sensing.hpp"
#include "slave/joint_servo.hpp"
#include "slave/robot.hpp"
#include "slave/user_force.hpp"
#include "slave/workspace.hpp"

namespace farhand {

struct SlaveConfig {
  double Ts = 0.001;                               // period of the tick [s]
  Duration stale = std::chrono::milliseconds(20);  // no message for so long holds all motion
  ArmGeometry arm;
  JointLimits joints;
  WorkspaceConfig workspace;
  JointServoConfig servo;
  ArmModel model;  // what the servo's feed-forward believes
  double torque_rise_time_s =
      0.02;  // a joint torque may go from 0 to its limit in this time: the slew limit
  std::optional<ForceSensingConfig> force_sensing;
  std::optional<BoundaryConfig> boundary;
  // Of bilateral architectures.
  bool sends_robot = false;                            // the robot's pose as a handle pose
  std::optional<AdmittanceConfig> admittance;          // the user's force moves the target
  std::optional<UserForceConfig> user_force;           // the user's force pushes the arm
  std::optional<CompensatedTargetConfig> compensated;  // in place of the handle's pose
  std::optional<AnswerDeadbandConfig> deadband;        // nothing: every tick is answered
};

// Everything one tick read, decided and sent; the recorder takes it whole.
struct SlaveTick {
  TimePoint now{};
  Duration age = Duration::max();  // of the master's message used
  RobotReading robot;
  Mode mode = Mode::disconnected;
  Reason reason = Reason::no_partner;
  bool coupled = false;
  bool aligned = true;         // as Alignment says; without it always
  Vec3 turn_M = Vec3::Zero();  // as Alignment says: while coupled, how far off it was coupled
  Pose X_SE;                   // of the measured joints
  Pose X_SE_target;  // where the robot is told to go: the handle's wish, or held at the boundary
  Vec6 q_cmd = Vec6::Zero();  // joint command after speed limits
  Vec6 tau = Vec6::Zero();    // written to the robot
  Wrench F_E_S;               // cleaned: tool weight and bias removed
  Status inverse = Status::ok;
  ArmSingularity singularity;
  LimitSet limits = kLimitNone;
  SlaveToMaster out;
  bool answers = true;  // `out` is to be sent: it tells something new
};

// The boundary's share in what a tick sent, at E, axes of S; of its torque nothing under rotation
// lock, and of all of it nothing with force_scale 0. For a slave with a boundary.
Wrench boundary_wrench(const WorkspaceConfig& workspace, const SlaveTick& tick) noexcept;

class Slave {
 public:
  explicit Slave(const SlaveConfig& config) noexcept;

  // One period. Write tick.tau to the robot, then send tick.out if the tick answers. The reference
  // stays valid until the next call.
  const SlaveTick& tick(TimePoint now, const Peer<MasterToSlave>& master,
                        const RobotReading& robot) noexcept;

  // From the next tick on STOPPED: the robot is held where it is.
  void stop() noexcept { stop_ = true; }

  const SlaveConfig& config() const noexcept { return config_; }
  const WorkspaceState& workspace() const noexcept { return workspace_; }
  const std::optional<Boundary>& boundary() const noexcept { return boundary_; }

 private:
  static constexpr std::uint32_t kNoPressIsNew = UINT32_MAX;

  void decide_mode(const Peer<MasterToSlave>& master, bool reads) noexcept;
  bool aligned(const MasterToSlave& in) noexcept;
  bool continues(const RobotReading& robot) noexcept;
  void stay_blind() noexcept;
  void find_again() noexcept;
  void move_target(const Peer<MasterToSlave>& master) noexcept;
  void follow_handle(const Peer<MasterToSlave>& master) noexcept;
  void follow_push(const MasterToSlave& in) noexcept;
  void follow_compensated(const Peer<MasterToSlave>& master) noexcept;
  void reach() noexcept;
  void command_joints(const ArmJacobian& J, const MasterToSlave* in) noexcept;
  void slow_down(Vec6& tau) noexcept;
  void answer(const MasterToSlave* in) noexcept;
  void tell_where() noexcept;

  SlaveConfig config_;
  Vec6 q_step_;     // largest joint command change per tick [rad]
  double braking_;  // and towards a joint limit, as a share of the way there
  Vec6 tau_max_;    // [N m]
  Vec6 tau_step_;   // [N m per tick]
  WorkspaceState workspace_;
  JointServo servo_;
  std::optional<ForceSensing> force_sensing_;
  std::optional<Boundary> boundary_;
  std::optional<Admittance> admittance_;
  std::optional<CompensatedTarget> compensated_;
  std::optional<Alignment> alignment_;
  std::optional<AnswerDeadband> deadband_;
  ModeState state_;
  bool stop_ = false;
  // Of the last message seen. Those of a master not heard yet were meant for no fault of ours.
  std::uint32_t clutch_presses_ = kNoPressIsNew;
  // Before this tick both sides waited for the handle: a press of the clutch means it as it is.
  bool turn_asked_ = false;
  JointContinuity continuity_;
  bool started_ = false;
  bool found_ = false;            // in the last tick, by one reading alone
  bool blind_ = false;            // through a fault
  Vec6 q_target_ = Vec6::Zero();  // of the newest reachable target
  SlaveTick tick_;
};

}  // namespace farhand
