// The figures of deploy/docs/ahrs.md, on simulated motion with a consumer's AHRS.
#include <cstdio>

#include "master/ahrs/kinematics_check.hpp"
#include "master/ahrs/sensor_fit.hpp"
#include "master/handle.hpp"
#include "tests/support/grip_rig.hpp"

namespace farhand {
namespace {

using support::GripCourse;
using support::GripRig;
using support::kDegrees;

struct Rms {
  double square = 0, most = 0;
  long count = 0;
  void add(double x) { square += x * x, most = std::max(most, std::abs(x)), ++count; }
  double value() const { return std::sqrt(square / static_cast<double>(count)); }
};

// Velocity against the truth so much earlier.
double error_at(const std::vector<Vec3>& v, const GripCourse& course, double first, double delay) {
  Rms rms;
  for (std::size_t k = 0; k < v.size(); k += 3)
    rms.add((v[k] - course.v(first + GripRig::kTs * static_cast<double>(k) - delay)).norm());
  return rms.value();
}

struct Delayed {
  double delay = 0, error = 0;  // [s, m/s]: the delay at which the error is least
};
Delayed least_error(const std::vector<Vec3>& v, const GripCourse& course, double first) {
  Delayed best{0, 1e9};
  for (int i = -20; i <= 80; ++i)
    if (const double e = error_at(v, course, first, 1e-4 * i); e < best.error) best = {1e-4 * i, e};
  return best;
}

std::vector<Vec3> differences(const std::vector<Vec3>& p, double cutoff_hz) {
  HandleVelocity filter(cutoff_hz, GripRig::kTs);
  std::vector<Vec3> out;
  for (const Vec3& x : p) out.push_back(filter.step({Mat3::Identity(), x}).linear);
  return out;
}

// The pole that delays as much; the difference itself delays half a tick.
double cutoff_for(double delay) {
  return std::min(1 / (2 * std::numbers::pi * std::max(delay - GripRig::kTs / 2, 1e-5)), 499.0);
}

struct Measured {
  Rms whole, tilt, yaw;
  double last_yaw = 0, last_yaw_sigma = 0;
  int beyond_three_sigma = 0;
  std::vector<Vec3> p, v;  // from kFrom on
};
constexpr double kFrom = 5;

Measured measure(const GripRig& rig, double duration) {
  Measured m;
  rig.run(duration, [&](const GripRig::Tick& tick) {
    if (tick.t < kFrom) return;
    const auto e = support::orientation_error(tick.estimate->X_MH.R, rig.course.R(tick.t));
    m.whole.add(e.whole), m.tilt.add(e.tilt), m.yaw.add(e.yaw);
    m.beyond_three_sigma += std::abs(e.yaw) > 3 * tick.estimate->yaw_sigma;
    m.last_yaw = e.yaw, m.last_yaw_sigma = tick.estimate->yaw_sigma;
    m.p.push_back(tick.p_encoder), m.v.push_back(tick.estimate->V_MH.linear);
  });
  return m;
}

TEST(AhrsMotion, OrientationIsWithinADegreeWithAMagnetometer) {
  for (const double rate : {50.0, 200.0}) {
    double worst = 0;
    for (std::uint64_t seed = 1; seed <= 8; ++seed) {
      GripRig rig{.ahrs = {.rate = rate}, .seed = seed};
      rig.motion.period = from_seconds(1 / rate);
      const Measured m = measure(rig, 60);
      std::printf(
          "ahrs %3.0f Hz, seed %d: orientation %.2f deg rms (tilt %.2f, yaw %.2f), %.2f at most\n",
          rate, static_cast<int>(seed), kDegrees * m.whole.value(), kDegrees * m.tilt.value(),
          kDegrees * m.yaw.value(), kDegrees * m.whole.most);
      worst = std::max(worst, kDegrees * m.whole.value());
      EXPECT_EQ(m.beyond_three_sigma, 0) << "seed " << seed;
    }
    EXPECT_LE(worst, 1.0) << rate;
  }
}

TEST(AhrsMotion, WithoutAMagnetometerTiltHoldsAndYawDriftsAsSaid) {
  double last = 0;
  for (std::uint64_t seed = 1; seed <= 5; ++seed) {
    GripRig rig{.ahrs = {.magnetometer = false}, .seed = seed};
    const Measured m = measure(rig, 120);
    std::printf(
        "ahrs without magnetometer, seed %d: tilt %.2f deg rms, yaw off %.2f deg after 2 min, said "
        "%.2f\n",
        static_cast<int>(seed), kDegrees * m.tilt.value(), kDegrees * m.last_yaw,
        kDegrees * m.last_yaw_sigma);
    EXPECT_LE(kDegrees * m.tilt.value(), 1.0) << "seed " << seed;
    EXPECT_EQ(m.beyond_three_sigma, 0) << "seed " << seed;
    last = m.last_yaw_sigma;
  }
  EXPECT_GE(kDegrees * last, 1.0);  // it does not claim what it cannot know
}

TEST(AhrsMotion, VelocityErrorIsHalfOfTheDifferencesAtEqualDelay) {
  for (const double rate : {50.0, 100.0, 200.0}) {
    GripRig rig{.ahrs = {.rate = rate}};
    rig.motion.period = from_seconds(1 / rate);
    const Measured m = measure(rig, 30);
    const Delayed fused = least_error(m.v, rig.course, kFrom);
    const Delayed equal = least_error(differences(m.p, cutoff_for(fused.delay)), rig.course, kFrom);
    const double now = error_at(m.v, rig.course, kFrom, 0);
    const Delayed usual = least_error(differences(m.p, 60), rig.course, kFrom);
    const double usual_now = error_at(differences(m.p, 60), rig.course, kFrom, 0);
    std::printf(
        "velocity, AHRS at %3.0f Hz: fused %.2f mm/s at %.1f ms (%.2f at 0); difference at equal "
        "delay %.2f mm/s "
        "at %.1f ms; through 60 Hz %.2f at %.1f ms (%.2f at 0)\n",
        rate, 1e3 * fused.error, 1e3 * fused.delay, 1e3 * now, 1e3 * equal.error, 1e3 * equal.delay,
        1e3 * usual.error, 1e3 * usual.delay, 1e3 * usual_now);
    EXPECT_LE(now, 0.5 * equal.error);
    EXPECT_LE(now, 0.5 * usual_now);
  }
  GripRig alone;
  std::vector<Vec3> p, v;
  alone.run(
      30,
      [&](const GripRig::Tick& tick) {
        if (tick.t >= kFrom) v.push_back(tick.estimate->V_MH.linear), p.push_back(tick.p_encoder);
      },
      [](double) { return true; });
  const Delayed kalman = least_error(v, alone.course, kFrom);
  std::printf("velocity, encoders alone through the observer: %.2f mm/s at %.1f ms (%.2f at 0)\n",
              1e3 * kalman.error, 1e3 * kalman.delay, 1e3 * error_at(v, alone.course, kFrom, 0));
}

TEST(AhrsMotion, ALatencyBelievedWrongCostsLessThanTheAhrsGains) {
  for (const int ms : {1, 3, 5, 7, 9}) {
    GripRig rig;
    rig.motion.latency = std::chrono::milliseconds(ms);
    const Measured m = measure(rig, 20);
    const double error = error_at(m.v, rig.course, kFrom, 0);
    std::printf("latency believed %d ms: velocity %.2f mm/s, orientation %.2f deg\n", ms,
                1e3 * error, kDegrees * m.whole.value());
    EXPECT_LE(error, 0.5 * error_at(differences(m.p, 60), rig.course, kFrom, 0)) << ms;
  }
}

TEST(AhrsMotion, LossIsNoJumpAndIsSaid) {
  GripRig rig;
  const auto silent = [](double t) { return t > 10 && t < 12; };
  double jump_R = 0, jump_w = 0, jump_v = 0, usual_v = 0, sigma = 0, held = 0;
  GripMotionEstimate last, at_loss;
  bool lost = false;
  AhrsState before = AhrsState::absent, during = AhrsState::absent, after = AhrsState::absent;
  rig.run(
      20,
      [&](const GripRig::Tick& tick) {
        const GripMotionEstimate& e = *tick.estimate;
        if (tick.t > kFrom) {
          // What a tick changes beyond what the velocities say.
          const Vec3 turned = rotation_vector(e.X_MH.R * last.X_MH.R.transpose());
          jump_R =
              std::max(jump_R, (turned - 0.0005 * (e.V_MH.angular + last.V_MH.angular)).norm());
          jump_w = std::max(jump_w, (e.V_MH.angular - last.V_MH.angular).norm());
          const double dv = (e.V_MH.linear - last.V_MH.linear).norm();
          (tick.t > 10 && tick.t < 12.2 ? jump_v : usual_v) =
              std::max(tick.t > 10 && tick.t < 12.2 ? jump_v : usual_v, dv);
        }
        if (tick.t < 9.9) before = e.ahrs;
        if (tick.t > 10.2 && tick.t < 11.9) during = e.ahrs, sigma = e.yaw_sigma;
        if (tick.t > 10.2 && tick.t < 11.9 && !lost) at_loss = e, lost = true;
        if (lost && tick.t < 11.9)
          held = std::max(held, rotation_vector(e.X_MH.R * at_loss.X_MH.R.transpose()).norm());
        if (tick.t > 19) after = e.ahrs;
        last = e;
      },
      silent);
  const double end = support::orientation_error(last.X_MH.R, rig.course.R(20 - GripRig::kTs)).whole;
  std::printf(
      "loss: orientation jumps %.3f deg at most, its rate %.1f deg/s, velocity %.2f mm/s a tick "
      "(%.2f in between); "
      "yaw said %.0f deg, 8 s later off by %.2f deg\n",
      kDegrees * jump_R, kDegrees * jump_w, 1e3 * jump_v, 1e3 * usual_v, kDegrees * sigma,
      kDegrees * end);
  EXPECT_EQ(before, AhrsState::ok);
  EXPECT_EQ(during, AhrsState::lost);
  EXPECT_EQ(after, AhrsState::ok);
  EXPECT_LE(held, 1e-9);
  EXPECT_GE(kDegrees * sigma, 10);
  EXPECT_LE(kDegrees * jump_R, 0.1);
  EXPECT_LE(kDegrees * jump_w, 15);  // of 90 deg/s
  EXPECT_LE(jump_v, 1.5 * usual_v);
  EXPECT_LE(kDegrees * end, 2);
}

KinematicsCheck checked(const FalconGeometry& believed, std::uint64_t seed) {
  KinematicsCheck check;
  GripRig{.believed = believed, .seed = seed}.run(40, [&](const GripRig::Tick& tick) {
    const GripMotionEstimate& e = *tick.estimate;
    if (tick.t > kFrom && e.compared) check.add(e.a_encoder_M, e.disagreement_M);
  });
  return check;
}

// Which of two encoder gears is right: the accelerometer tells.
TEST(AhrsMotion, TheAccelerometerChecksTheKinematics) {
  FalconGeometry other = kFalconTable1;
  other.gear_ratio = kFalconLibnifalcon.gear_ratio;
  for (std::uint64_t seed = 1; seed <= 3; ++seed) {
    const KinematicsCheck right = checked(kFalconTable1, seed), wrong = checked(other, seed);
    std::printf(
        "AHRS over encoders, x y z: %.4f %.4f %.4f, residual %.3f m/s^2; believing a gear %.2f %% "
        "off: "
        "%.4f %.4f %.4f, %.3f\n",
        right.scale().x(), right.scale().y(), right.scale().z(), right.residual(),
        100 * (other.gear_ratio / kFalconTable1.gear_ratio - 1), wrong.scale().x(),
        wrong.scale().y(), wrong.scale().z(), wrong.residual());
    EXPECT_LE((right.scale() - Vec3::Ones()).cwiseAbs().maxCoeff(), 0.006) << "seed " << seed;
    EXPECT_GE((wrong.scale() - right.scale()).minCoeff(), 0.006) << "seed " << seed;
  }
}

// As it comes out of its box an accelerometer is too far off for a degree; resting in a dozen
// orientations makes it right.
TEST(AhrsMotion, RestsInManyOrientationsFitOffsetAndScale) {
  double worst = 0, raw = 0;
  for (std::uint64_t seed = 1; seed <= 20; ++seed) {
    Random random(seed);
    const auto vector = [&](double size) {
      const double x = random.normal(), y = random.normal(), z = random.normal();
      return Vec3(size * Vec3(x, y, z));
    };
    const Vec3 offset = vector(0.6), scale = Vec3::Ones() + vector(0.01);
    std::vector<Vec3> rests;
    for (int i = 0; i < 14; ++i) {
      const Vec3 up = kGravity * vector(1).normalized();
      rests.push_back(scale.cwiseProduct(up) + offset + vector(2.9e-3));  // of a second's mean
    }
    const auto fitted = fit_sensor(rests, kGravity);
    if (!fitted) continue;  // orientations by chance too much alike
    for (int i = 0; i < 50; ++i) {
      const Vec3 up = kGravity * vector(1).normalized();
      const Vec3 reading = scale.cwiseProduct(up) + offset;
      raw = std::max(raw, (reading - up).norm());
      worst = std::max(worst, (fitted->fit(reading) - up).norm());
    }
    EXPECT_LE(fitted->residual, 0.01) << "seed " << seed;
  }
  std::printf("accelerometer: off by %.3f m/s^2 at most, %.4f after the fit\n", raw, worst);
  EXPECT_LE(worst, 0.03);  // the default of sim_ahrs.hpp
}

TEST(AhrsMotion, OrientationsTooMuchAlikeFitNothing) {
  std::vector<Vec3> rests(14, Vec3(0, kGravity, 0));
  EXPECT_FALSE(fit_sensor(rests, kGravity));
  for (std::size_t i = 0; i < rests.size(); ++i)
    rests[i] = Mat3(Eigen::AngleAxisd(0.4 * static_cast<double>(i), Vec3::UnitX())) * rests[i];
  EXPECT_FALSE(fit_sensor(rests, kGravity));  // never off one plane
  EXPECT_FALSE(fit_sensor(std::span(rests).first(8), kGravity));
}

}  // namespace
}  // namespace farhand
