// Pose, velocity and acceleration of a grip whose place encoders tell at every tick and whose
// orientation an AHRS on it tells more seldom and late.
//
// An AHRS sample is dated by its device's clock and the least delay that this showed lately;
// without one by counting periods that follow the arrivals. The latency that is known is taken off.
// Its gyroscope turns the attitude filter; its specific force, in M axes and moved from the sensor
// to H, less gravity is the acceleration that the observer takes. The same force less the
// acceleration of the encoders is what the attitude filter takes for up: so a shaken grip stays
// upright.
//
// While no sample comes the orientation goes on turning for coast, slows down until lost and then
// stays; its uncertainty grows. Position and velocity become those of the encoders alone
// (grip_observer.hpp) and stay so until the tilt is known again. The orientation given turns as the
// gyroscope says and goes to the filter's at return_rate at most: nothing jumps.
#pragma once

#include "common/recent_minimum.hpp"
#include "master/ahrs/attitude_filter.hpp"
#include "master/ahrs/grip_observer.hpp"
#include "master/ahrs/sample.hpp"

namespace farhand {

struct GripMotionConfig {
  AttitudeFilterConfig attitude{};
  GripObserverConfig observer{};
  SensorFit acceleration{}, magnetic{};            // in the sensor's axes, applied first
  Mat3 R_HI = Mat3::Identity();                    // sensor I on the grip
  Vec3 p_HI = Vec3::Zero();                        // [m]
  Duration latency{std::chrono::milliseconds(5)};  // least, from motion to arrival
  Duration period{std::chrono::milliseconds(5)};   // between samples, for those without a clock
  double align_s = 1;                              // [s] of samples averaged at start
  Duration coast{std::chrono::milliseconds(30)};   // age of a sample
  Duration lost{std::chrono::milliseconds(100)};   // age of a sample
  double lost_turn_rate = 0.5;  // [rad/s] standard deviation of how the grip turns meanwhile
  double return_rate = 0.5;     // [rad/s]
  double sure_tilt = 0.05;      // [rad] beyond this standard deviation gravity is not told apart
                                // from acceleration, and the encoders are alone
};

enum class AhrsState : std::uint8_t { absent, aligning, ok, lost };

struct GripMotionEstimate {
  AhrsState ahrs = AhrsState::absent;
  Pose X_MH;
  Twist V_MH;                // at H, axes of M
  Vec3 a_MH = Vec3::Zero();  // [m/s^2]
  double tilt_sigma = 0;     // [rad] standard deviations of the orientation
  double yaw_sigma = 0;      // about up
  // The newest instant that AHRS and encoders both know: acceleration by the encoders, and what the
  // AHRS says beyond it and gravity [m/s^2].
  bool compared = false;  // it came in this tick
  Vec3 a_encoder_M = Vec3::Zero();
  Vec3 disagreement_M = Vec3::Zero();
};

class GripMotion {
 public:
  explicit GripMotion(const GripMotionConfig& config) noexcept;

  // A sample that arrived by now; before the step of the same tick.
  void take(const AhrsSample& sample, TimePoint arrived) noexcept;
  // One tick. p_MH [m]: nothing if the encoders are silent; then position holds at zero velocity.
  const GripMotionEstimate& step(TimePoint now, const Vec3* p_MH) noexcept;

  const AttitudeFilter& filter() const noexcept { return filter_; }

 private:
  struct Force {
    TimePoint at{};
    double dt = 0;  // [s] since the sample before
    Vec3 force_M = Vec3::Zero();
  };
  struct Alignment {
    int count = 0;
    TimePoint begin{};
    Vec3 gyro = Vec3::Zero(), force = Vec3::Zero(), magnetic = Vec3::Zero();
    Vec3 least = Vec3::Zero(), most = Vec3::Zero();  // of the gyroscope
  };
  TimePoint date(const AhrsSample& sample, TimePoint arrived) noexcept;
  TimePoint date_by_arrival(TimePoint arrived) const noexcept;
  void align(const AhrsSample& sample, TimePoint at) noexcept;
  void turn(const AhrsSample& sample, TimePoint at) noexcept;
  void observe(TimePoint now) noexcept;
  void compare(TimePoint now) noexcept;
  void turn_forces(const Quat& turn_M) noexcept;
  std::optional<Vec3> smoothed_force(std::uint64_t sample, double reach) const noexcept;
  Vec3 encoder_acceleration(int middle) const noexcept;
  void orient(TimePoint now) noexcept;
  const Force& force(std::uint64_t sample) const noexcept { return forces_[sample % kForces]; }
  double ticks(Duration d) const noexcept { return seconds(d) / config_.observer.Ts; }

  GripMotionConfig config_;
  AttitudeFilter filter_;
  GripObserver observer_;
  int half_block_;  // [ticks] of the encoders' acceleration

  RecentMinimum delay_;
  Duration first_delay_{}, device_time_{-1};
  bool started_ = false;  // a sample came
  bool upright_ = false;  // the filter has its first orientation
  TimePoint last_{};      // instant of the last sample
  Vec3 gyro_H_ = Vec3::Zero();
  Alignment alignment_;
  static constexpr std::uint64_t kForces = 32;
  std::array<Force, kForces> forces_{};  // the last ones
  // Samples so far: that came, that the observer has, that were compared with the encoders.
  std::uint64_t taken_ = 0, observed_ = 0, compared_ = 0;

  double rate_ = 0;  // share of the turning that is believed
  GripMotionEstimate given_;
};

}  // namespace farhand
