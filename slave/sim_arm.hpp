// The simulated robot: the arm's rigid-body dynamics (reference 7.4), gear friction, drives that
// saturate, encoders, a force/torque sensor, and surfaces to touch. The same in virtual and real
// time: its only clock is the `now` it is given.
#pragma once

#include <cstddef>
#include <cstdint>
#include <vector>

#include "common/random.hpp"
#include "slave/arm_dynamics.hpp"
#include "slave/contact.hpp"
#include "slave/gear_friction.hpp"
#include "slave/robot.hpp"

namespace farhand {

// Force/torque sensor at the wrist, referred to E. It carries the tool, so that it reads
// F = F_contact - weight of the tool + bias + noise; inertial forces of the tool are left out.
struct SensorConfig {
  double force_noise_newton = 0;         // standard deviation per reading and axis
  double torque_noise_newton_metre = 0;  // the same
  Wrench bias_E{};                       // E axes, constant
  double tool_mass_kg = 0;               // beyond the sensor; already part of link 6
  Vec3 tool_com_E = Vec3::Zero();        // [m]
};

enum class VelocitySource : std::uint8_t {
  exact,    // the plant's own
  encoder,  // difference of the encoder's readings, low-passed
};

struct SurfaceStep {
  std::size_t surface = 0;
  Duration at{};  // since the first call
  Vec3 by = Vec3::Zero();
};

struct SimArmConfig {
  ArmModel model{};
  double rate_hz = 1000;  // of the integration, 1000 to 10000
  bool friction = true;
  Vec6 q = Vec6::Zero();           // at the start [rad], at rest
  double encoder_quantum_rad = 0;  // 0: ideal
  VelocitySource velocity = VelocitySource::exact;
  double velocity_cutoff_hz = 100;  // of the encoder difference; 0: no filter
  Surfaces surfaces{};
  std::vector<SurfaceStep> surface_steps;  // by time
  double tip_radius_m = 0;
  SensorConfig sensor{};
  std::uint64_t seed = 1;
};

// What a checker may know and a controller may not.
struct SimArmTruth {
  Vec6 q = Vec6::Zero(), dq = Vec6::Zero();
  Vec6 tau = Vec6::Zero();  // applied: held, clamped
  Pose X_SE{};
  Twist V_E_S{};
  Wrench F_E_S{};          // robot on environment, at E
  double penetration = 0;  // deepest [m]; <= 0: free
  double energy = 0;       // of the arm [J]
};

struct SimArmStatus {
  std::uint64_t steps = 0;        // of the integrator
  Duration skipped{};             // time not simulated, because a call came too late
  std::uint64_t bad_torques = 0;  // written but not finite, held as zero
};

class SimArm {
 public:
  static constexpr bool kReal = false;

  explicit SimArm(const SimArmConfig& config) noexcept;

  // Both first bring the plant to `now` under the torque held so far, in equal Runge-Kutta steps as
  // near to rate_hz as divides the time; the first call only sets the clock. Time standing still or
  // running back does nothing; of more than kMaxCatchUp only kMaxCatchUp is simulated, and then it
  // rests, as one whose brakes fall in when nobody drives it.
  RobotReading read(TimePoint now) noexcept;  // ok = false once the state is no longer finite
  void write(TimePoint now, const Vec6& tau) noexcept;  // clamped to each joint's limit

  static constexpr Duration kMaxCatchUp = std::chrono::milliseconds(50);

  SimArmTruth truth() const noexcept;
  const SimArmStatus& status() const noexcept { return status_; }
  const SimArmConfig& config() const noexcept { return config_; }

 private:
  void advance(TimePoint now) noexcept;
  void move_surfaces() noexcept;
  void step(double h) noexcept;
  void runge_kutta(double h) noexcept;
  void look_for_contact(double h) noexcept;
  Vec6 acceleration(const Vec6& q, const Vec6& dq) const noexcept;
  Tip tip(const Vec6& q, const Vec6& dq) const noexcept;
  Wrench sensed(const Tip& tip) noexcept;
  void read_velocity(TimePoint now, RobotReading& out) noexcept;

  SimArmConfig config_;
  ArmDynamics arm_;
  GearFriction gears_;
  Vec6 torque_limit_;
  Random random_;

  Vec6 q_, dq_ = Vec6::Zero(), tau_ = Vec6::Zero();
  Vec6 feet_;  // of the gears' bristles
  ContactState contact_;
  bool near_ = false;               // a surface is within reach of this step
  std::size_t surfaces_moved_ = 0;  // of the steps
  bool started_ = false;
  TimePoint first_{}, last_{};
  bool measured_ = false;  // the encoder difference has a past
  TimePoint last_read_{};
  Vec6 q_read_ = Vec6::Zero(), dq_read_ = Vec6::Zero();
  SimArmStatus status_;
};
static_assert(Robot<SimArm>);

}  // namespace farhand
