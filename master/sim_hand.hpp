// The simulated device and operator behind the seam of haptic_device.hpp: a hand's mass and spring
// around the same kinematics. read() and write() first advance the plant to `now` under the torques
// held since the last write; nothing else makes time pass. The first call is time zero of the
// operator's script. Deterministic for a seed and a sequence of calls; nothing allocates after
// construction.
//
// The mechanism is solved at every read and at least every 2 ms of plant time; in between the
// motors' push is held. At the edge of the mechanism the handle stops without rebound.
//
// With an AHRS on a handle that only translates, the hand turns the grip on its joint by the
// rotation vector (M axes) that its motion gives, at once and without effort; the sensor's bytes go
// through the parser of a real one.
#pragma once

#include <cstdint>
#include <optional>
#include <vector>

#include "common/random.hpp"
#include "master/ahrs/sim_ahrs.hpp"
#include "master/hand_linkage.hpp"
#include "master/hand_plant.hpp"
#include "master/haptic_device.hpp"
#include "master/motion.hpp"

namespace farhand {

enum class Button : std::uint8_t { dead_man, clutch };

struct Press {
  Button button = Button::dead_man;
  double at = 0.5;         // [s]
  double lasting = 86400;  // [s]
};

// force sin(pi (t - at) / lasting) on the grip, in M.
struct Push {
  double at = 0;         // [s]
  double lasting = 0.5;  // [s] > 0
  Vec3 force = Vec3::Zero();
};

struct OperatorConfig {
  HandImpedance impedance{};
  MotionConfig motion{};  // about where the grip starts
};

struct SimHandConfig {
  PlantConfig device{};
  std::optional<OperatorConfig> user{};  // without: nobody holds the grip
  std::vector<Press> presses{Press{}};
  std::vector<Push> pushes{};
  std::optional<Vec3> start_p_MH{};  // without: the middle of the workspace
  double encoder_step = 1.3e-4;      // [rad] of a motor joint; 0: ideal
  double max_motor_torque = 3.0;     // [N m] > 0, the vector is scaled as a whole
  double motor_gain = 1;             // what the motors give of the torque they are told
  bool force_sensor = true;          // in a handle that rotates; a Falcon has none
  double force_noise = 0.0212;       // [N] standard deviation, each axis of either end's sensor
  EndForces sensor_bias{};           // [N] of the same
  double grip_mass = 0;              // [kg] whose weight the sensors feel, centred at H; that
                                     // weight is part of the device's, its inertia of the hand's
  double rate = 5000;                // [Hz] steps of the plant
  std::uint64_t seed = 1;
  std::optional<SimAhrsConfig> ahrs{};  // on the grip of a handle that does not rotate
};

// What really happens, for checkers and logs; no controller sees it.
struct HandTruth {
  double t = 0;  // [s] of plant time
  HandState state;
  HandCourse wish;               // of the hand; the handle itself when nobody holds it
  HandLoad user;                 // the user side on the device, where the sensor sits
  GripTruth grip;                // at the last reading, with an AHRS
  Vec6 theta = Vec6::Zero();     // not quantised
  Vec6 tau = Vec6::Zero();       // torques that act, limited
  std::uint64_t stops = 0;       // solutions at which the mechanism's edge stopped the handle
  std::uint64_t skipped = 0;     // calls that came more than 50 ms late; the rest was left out
  std::uint64_t bad_torque = 0;  // writes that were not finite and became zero
  std::uint64_t saturated = 0;   // writes that exceeded the motors
};

template <typename Geometry>
class SimHand {
 public:
  static constexpr bool kReal = false;

  // Throws std::runtime_error with a sentence when the start lies outside the mechanism, when the
  // rate is too low for the springs, or when the motion is refused (see Motion).
  SimHand(const Geometry& geometry, SimHandConfig config);

  HandleReading read(TimePoint now) noexcept;
  void write(TimePoint now, const Vec6& tau) noexcept;
  // From now on the hand turns at this rate besides its motion: tilt about x, about y, twist
  // [rad/s].
  void turn(const Vec3& rate) noexcept;
  const HandTruth& truth() const noexcept { return truth_; }
  const std::optional<Motion>& motion() const noexcept { return motion_; }

 private:
  void advance(TimePoint now) noexcept;
  void run(Duration span) noexcept;
  void solve() noexcept;
  bool stop_at_edge() noexcept;
  HandCourse wish_at(double t) const noexcept;
  Vec3 turned_at(double t) const noexcept { return turned_ + (t - turning_since_) * turn_rate_; }
  Vec3 push_at(double t) const noexcept;
  bool pressed(Button button) const noexcept;
  Mat3 wrist_at(double t) const noexcept;
  GripTruth grip() const noexcept;
  EndForces sense_ends() noexcept;

  HandLinkage<Geometry> linkage_;
  SimHandConfig config_;
  Plant plant_;
  std::optional<Motion> motion_;
  Vec3 middle_;                                            // of the hand's motion
  Vec3 turned_ = Vec3::Zero(), turn_rate_ = Vec3::Zero();  // besides it
  double turning_since_ = 0;                               // [s] of plant time
  Vec3 a_MH_ = Vec3::Zero();                               // [m/s^2] over the plant's last step
  Random random_;
  struct Ahrs {
    SimAhrs sensor;
    AhrsParser parser;
  };
  std::optional<Ahrs> ahrs_;

  std::optional<TimePoint> now_;
  Duration lived_{0};     // plant time
  Duration unsolved_{0};  // since the last solution
  HandState last_inside_;
  HandLoad motors_;
  HandTruth truth_;
};

extern template class SimHand<FalconGeometry>;
extern template class SimHand<TwinDeltaGeometry>;

}  // namespace farhand
