// A simulated AHRS of consumer grade: what the grip really does becomes samples with noise, offset,
// drift, scale, step and delay, and these become the bytes of a real one's serial line. The
// defaults are of the class of BMI270, ICM-42688-P and BMM150 after a calibration by the user;
// deploy/docs/ahrs.md has the table. Deterministic for a seed and a sequence of calls.
#pragma once

#include <array>
#include <span>

#include "common/random.hpp"
#include "master/ahrs/frames.hpp"

namespace farhand {

// Of one sensor with three axes, in its unit.
struct SensorError {
  double noise = 0;   // per sqrt(Hz), over half the rate
  double offset = 0;  // standard deviation of each axis' constant offset
  double walk = 0;    // per sqrt(s), of the offset
  double scale = 0;   // standard deviation of each axis' share
  double step = 0;    // of the numbers; 0: none
};

struct SimAhrsConfig {
  AhrsFormat format = AhrsFormat::native;
  double rate = 200;                               // [Hz]
  Duration latency{std::chrono::milliseconds(5)};  // from motion to the last byte, at least
  Duration jitter{std::chrono::milliseconds(1)};   // and up to so much more
  bool magnetometer = true;
  bool attitude = false;
  SensorError gyro{
      .noise = 1.75e-4, .offset = 0.0175, .walk = 5e-5, .scale = 0.004, .step = 1.07e-3 / 4};
  SensorError acceleration{
      .noise = 2.9e-3, .offset = 0.03, .walk = 1e-3, .scale = 0.002, .step = 1.2e-3};
  SensorError magnetic{.noise = 6e-8, .offset = 5e-7, .walk = 0, .scale = 0.01, .step = 3e-7};
  Vec3 up_M = Vec3::UnitY();
  Vec3 field_M{6e-6, -4.4e-5, -1.9e-5};  // [T], of central Europe
  Mat3 R_HI = Mat3::Identity();
  Vec3 p_HI = Vec3::Zero();
  double lost = 0;  // share of frames that never arrive
};

// What the grip does at an instant.
struct GripTruth {
  Mat3 R_MH = Mat3::Identity();
  Vec3 omega_H = Vec3::Zero();  // [rad/s]
  Vec3 alpha_H = Vec3::Zero();  // [rad/s^2]
  Vec3 a_MH = Vec3::Zero();     // [m/s^2] of H, gravity not in it
};

class SimAhrs {
 public:
  SimAhrs(const SimAhrsConfig& config, std::uint64_t seed) noexcept;

  // A sample is made if one is due by now. Call it more often than the rate.
  void advance(TimePoint now, const GripTruth& truth) noexcept;
  // Bytes that have arrived by now; valid until the next call.
  std::span<const std::byte> read(TimePoint now) noexcept;

 private:
  class Sensor {
   public:
    Sensor(const SensorError& error, double rate, Random& random) noexcept;
    Vec3 read(const Vec3& truth, Random& random) noexcept;

   private:
    SensorError error_;
    double noise_, walk_;  // per sample
    Vec3 offset_, scale_;
  };
  struct Frame {
    TimePoint due{};
    std::size_t size = 0;
    std::array<std::byte, kMaxFrameBytes> bytes;
  };
  AhrsSample sample(TimePoint now, const GripTruth& truth) noexcept;

  SimAhrsConfig config_;
  Random random_;
  Sensor gyro_, acceleration_, magnetic_;
  Duration period_;
  bool started_ = false;
  TimePoint begin_{}, next_{};
  std::array<Frame, 32> line_{};  // on their way
  std::size_t first_ = 0, count_ = 0;
  std::array<std::byte, 4 * kMaxFrameBytes> arrived_{};
};

}  // namespace farhand
