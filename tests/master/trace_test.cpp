#include "master/trace.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <cstdio>
#include <cstdlib>
#include <filesystem>
#include <numbers>

#include "common/random.hpp"
#include "tests/support/temporary_file.hpp"

namespace farhand {
namespace {

constexpr double kPi = std::numbers::pi;
constexpr std::uint64_t kSeed = 11;

template <typename Path>
Recording record(double duration, double step, Path&& path) {
  Recording r;
  for (double t = 0; t <= duration; t += step) {
    r.t.push_back(t);
    r.p.push_back(path(t));
  }
  return r;
}

Vec3 circle(double t) {
  return Vec3(1, 2, 3) + 0.02 * Vec3(std::cos(2 * kPi * 0.5 * t), std::sin(2 * kPi * 0.5 * t), 0);
}

// The extremes of a trace between its first and last moment.
struct Extremes {
  double reach = 0, tilt = 0, speed = 0, turn_rate = 0, acceleration = 0;
};

Extremes extremes(const Trace& trace, double step = 1e-3) {
  Extremes e;
  Vec3 before = Vec3::Zero();
  for (double t = -0.1; t < trace.duration() + 0.1; t += step) {
    const MotionSample s = trace.at(t);
    e.reach = std::max(e.reach, s.p.norm());
    e.tilt = std::max(e.tilt, s.turn.head<2>().norm());
    e.speed = std::max(e.speed, s.v.norm());
    e.turn_rate = std::max(e.turn_rate, s.turn_rate.norm());
    e.acceleration = std::max(e.acceleration, (s.v - before).norm() / step);
    before = s.v;
  }
  return e;
}

TEST(Trace, ASlowCircleIsKeptAroundItsCentre) {
  const Trace trace(record(10, 0.004, circle), {}, {});
  EXPECT_EQ(trace.report().scale, 1);
  EXPECT_EQ(trace.report().slowed, 0);
  EXPECT_NEAR(trace.report().recorded, 10, 0.005);
  for (double t = 3; t < 9; t += 0.01) EXPECT_NEAR(trace.at(t).p.norm(), 0.02, 2e-4) << t;
}

TEST(Trace, StartsAndEndsAtRestInTheCentre) {
  const Trace trace(record(10, 0.004, circle), {}, {});
  for (const double t : {-5.0, 0.0, trace.duration(), trace.duration() + 5}) {
    EXPECT_LT(trace.at(t).p.norm(), 1e-15) << t;
    EXPECT_LT(trace.at(t).v.norm(), 1e-15) << t;
  }
  EXPECT_LT(trace.at(0.05).v.norm(), 1e-3);
  EXPECT_GT(trace.at(5).v.norm(), 0.05);
}

TEST(Trace, VelocityIsTheDerivativeOfPosition) {
  const Trace trace(record(6, 0.004, circle), {}, {});
  const double h = 1e-5;
  for (double t = 0.013; t < trace.duration(); t += 0.0371) {
    const Vec3 slope = (trace.at(t + h).p - trace.at(t - h).p) / (2 * h);
    EXPECT_LT((slope - trace.at(t).v).norm(), 1e-7) << t;
  }
}

TEST(Trace, TheLargestScaleThatFitsIsTakenAndALargerOneRefused) {
  const Recording r = record(10, 0.01, [](double t) { return Vec3(10 * circle(t)); });
  const Trace fitted(r, {.reach = 0.03}, {});
  EXPECT_NEAR(fitted.report().scale, 0.03 / 0.2, 1e-3);
  EXPECT_LE(extremes(fitted).reach, 0.03);
  EXPECT_GT(extremes(fitted).reach, 0.0295);
  EXPECT_EQ(Trace(r, {.scale = 0.1, .reach = 0.03}, {}).report().scale, 0.1);
  const std::string why = refusal([&] { Trace(r, {.scale = 0.2, .reach = 0.03}, {}); });
  EXPECT_NE(why.find("largest scale that fits is 0.15"), std::string::npos) << why;
}

TEST(Trace, AFastMotionIsSlowedJustBelowTheLimitAndASlowOneIsNot) {
  const auto path = [](double t) { return Vec3(0.03 * std::sin(2 * kPi * 2 * t), 0, 0); };
  const Trace slowed(record(5, 0.005, path), {}, {.speed = 0.2});
  EXPECT_LE(extremes(slowed).speed, 0.2);
  EXPECT_GT(extremes(slowed).speed, 0.18);
  EXPECT_GT(slowed.report().slowed, 4);
  EXPECT_NEAR(slowed.report().slowest_rate, 0.2 / (0.03 * 2 * kPi * 2), 0.03);
  const Trace free(record(5, 0.005, path), {}, {.speed = 0.5});
  EXPECT_EQ(free.report().slowed, 0);
  EXPECT_GT(slowed.duration(), free.duration() + 2);
}

TEST(Trace, OnlyTheFastPartIsSlowed) {
  const auto path = [](double t) {
    const double s = std::clamp((t - 5) / 0.1, 0.0, 1.0);
    return Vec3(0.001 * std::sin(t) + 0.03 * s * s * (3 - 2 * s), 0, 0);
  };
  const Trace trace(record(10, 0.002, path), {}, {.speed = 0.1});
  EXPECT_LE(extremes(trace).speed, 0.1);
  EXPECT_GT(trace.report().slowed, 0.1);
  EXPECT_LT(trace.report().slowed, 1.5);
}

TEST(Trace, NoiseGoesAndHumanMotionStays) {
  Random random(kSeed);
  const auto path = [](double t) { return Vec3(0.02 * std::sin(2 * kPi * t), 0, 0); };
  Recording r = record(10, 0.001, path);
  for (Vec3& p : r.p) p.y() = 1e-4 * random.normal();
  const Trace trace(r, {}, {});
  const Extremes e = extremes(trace);
  EXPECT_NEAR(e.reach, 0.02, 1e-3) << "seed " << kSeed;
  EXPECT_LT(e.acceleration, 1.3) << "seed " << kSeed;  // the motion 0.8, raw differences 240
}

TEST(Trace, UnevenStepsAndDropoutsChangeLittle) {
  Random random(kSeed);
  Recording r;
  for (double t = 0; t < 10;
       t += random.uniform() < 0.01 ? 0.06 : 0.001 + 0.01 * random.uniform()) {
    r.t.push_back(t);
    r.p.push_back(circle(t));
  }
  const Trace rough(r, {}, {}), even(record(10, 0.001, circle), {}, {});
  EXPECT_GE(rough.report().largest_gap, 0.06);
  for (double t = 0; t < 9; t += 0.01)
    EXPECT_LT((rough.at(t).p - even.at(t).p).norm(), 5e-4) << t << " seed " << kSeed;
}

TEST(Trace, TiltAndTwistAreTakenFromTheMeanScaledAndLimited) {
  const Quat base(Eigen::AngleAxisd(2.2, Vec3(1, -2, 0.5).normalized()));
  Recording r = record(20, 0.01, [](double) { return Vec3::Zero(); });
  for (const double t : r.t) {
    const double s = std::sin(2 * kPi * 0.2 * t), s2 = std::sin(2 * kPi * 0.4 * t);
    const Mat3 tilt = rotation(Vec3(0.6 * s, -0.2 * s, 0));
    r.q.push_back(Quat(tilt * rotation(Vec3(0, 0, 0.4 * s2))) * base);
  }
  const Trace half(r, {.rotation_scale = 0.5, .max_tilt = 1}, {});
  EXPECT_NEAR(extremes(half).tilt, 0.5 * std::hypot(0.6, 0.2), 0.002);
  double twist = 0;
  for (double t = 0; t < half.duration(); t += 0.01) {
    EXPECT_NEAR(half.at(t).turn.x(), -3 * half.at(t).turn.y(), 0.002) << t;
    twist = std::max(twist, half.at(t).turn.z());
  }
  EXPECT_NEAR(twist, 0.5 * 0.4, 0.002);
  EXPECT_LE(extremes(Trace(r, {.rotation_scale = 1, .max_tilt = 0.3}, {})).tilt, 0.3 + 1e-12);
  EXPECT_EQ(extremes(Trace(r, {.rotation_scale = 0}, {})).tilt, 0);
  EXPECT_LE(extremes(Trace(r, {.max_tilt = 1}, {.turn_rate = 0.1})).turn_rate, 0.1 + 1e-12);
}

TEST(Trace, ATwistBeyondHalfATurnGoesOn) {
  Recording r = record(20, 0.01, [](double) { return Vec3::Zero(); });
  for (const double t : r.t) r.q.push_back(Quat(rotation(Vec3(0, 0, 4 * std::sin(0.3 * t)))));
  const Trace trace(r, {.rotation_scale = 1}, {.turn_rate = 3});
  double largest = 0, smallest = 0;
  for (double t = 0; t < trace.duration(); t += 0.01) {
    largest = std::max(largest, trace.at(t).turn.z());
    smallest = std::min(smallest, trace.at(t).turn.z());
  }
  EXPECT_NEAR(largest - smallest, 8, 0.3);
}

TEST(Trace, AHandThatNeverMovesStaysInTheCentre) {
  const Trace trace(record(1, 0.5, [](double) { return Vec3(7, 8, 9); }), {}, {});
  EXPECT_EQ(trace.report().scale, 1);
  EXPECT_LT(extremes(trace).reach, 1e-12);
}

// The recordings kept outside the repository, where they are at hand.
TEST(Trace, RecordedHandsObeyTheLimits) {
  const char* dir = std::getenv("FARHAND_TRACES_DIR");
  if (dir == nullptr) GTEST_SKIP() << "FARHAND_TRACES_DIR is not set: no recorded traces to load";
  const TraceConfig config;
  const SpeedLimits limits{.speed = 0.15, .turn_rate = 0.5};
  std::printf("%-34s %6s %6s %6s %6s %7s %6s %6s %7s\n", "trace", "rows", "rec s", "run s", "scale",
              "slow s", "m/s", "m/s2", "rad/s");
  int files = 0;
  for (const auto& entry : std::filesystem::directory_iterator(dir)) {
    if (entry.path().extension() != ".csv") continue;
    const Trace trace(read_recording(entry.path().string()), config, limits);
    const TraceReport& r = trace.report();
    const Extremes e = extremes(trace);
    std::printf("%-34s %6zu %6.1f %6.1f %6.3f %7.2f %6.3f %6.2f %7.3f\n",
                entry.path().filename().c_str(), r.rows, r.recorded, r.duration, r.scale, r.slowed,
                e.speed, e.acceleration, e.turn_rate);
    EXPECT_LE(e.reach, config.reach + 1e-12) << entry.path();
    EXPECT_LE(e.tilt, config.max_tilt + 1e-12) << entry.path();
    EXPECT_LE(e.speed, limits.speed + 1e-12) << entry.path();
    EXPECT_LE(e.turn_rate, limits.turn_rate + 1e-12) << entry.path();
    EXPECT_LE(e.acceleration, 5) << entry.path();
    EXPECT_GE(r.duration, r.recorded) << entry.path();
    ++files;
  }
  EXPECT_GT(files, 0) << "no .csv files in " << dir;
}

}  // namespace
}  // namespace farhand
