// The two halves of the fusion, each alone and with worked numbers.
#include <numbers>

#include "master/ahrs/attitude_filter.hpp"
#include "master/ahrs/grip_motion.hpp"
#include "tests/support/allocations.hpp"

namespace farhand {
namespace {

constexpr double kDt = 0.005, kDegree = std::numbers::pi / 180;
const Vec3 kUp = Vec3::UnitY(), kForce = kGravity * kUp, kField(0, -4e-5, -2e-5);

AttitudeFilter started(const Vec3* field = nullptr, const Vec3& bias = Vec3::Zero()) {
  AttitudeFilter filter(AttitudeFilterConfig{});
  filter.start(kForce, bias, true, field);
  return filter;
}

TEST(AttitudeFilter, AQuarterTurnByTheGyroscopeIsAQuarterTurn) {
  AttitudeFilter filter = started();
  const Vec3 omega(0, 0, std::numbers::pi / 2);
  for (int i = 0; i < 200; ++i) filter.turn(omega, kDt);
  EXPECT_NEAR((filter.q_MH() * Vec3::UnitX() - Vec3::UnitY()).norm(), 0, 1e-12);
}

TEST(AttitudeFilter, StartsUprightWhateverWayTheSensorHangs) {
  AttitudeFilter filter(AttitudeFilterConfig{});
  for (const Vec3& force : {Vec3(9.81, 0, 0), Vec3(0, -9.81, 0), Vec3(1, 2, -9)}) {
    filter.start(force, Vec3::Zero(), true, nullptr);
    EXPECT_NEAR((filter.q_MH() * force.normalized() - kUp).norm(), 0, 1e-12);
  }
}

TEST(AttitudeFilter, FindsTiltYawAndTheBiasThatMadeThem) {
  AttitudeFilter filter = started(&kField);
  const Vec3 bias(0.02, -0.015, 0.01);  // held still, but for a shiver that hides the rest
  for (int i = 0; i < 40'000; ++i) {
    filter.turn(bias + Vec3::Constant(i % 2 == 0 ? 0.05 : -0.05), kDt);
    filter.correct_tilt(filter.q_MH() * kForce, kDt);
    filter.correct_yaw(filter.q_MH() * kField, kDt);
  }
  EXPECT_FALSE(filter.at_rest());
  EXPECT_NEAR((filter.bias() - bias).norm(), 0, 1e-3);
  EXPECT_NEAR(filter.q_MH().angularDistance(Quat::Identity()), 0, 0.1 * kDegree);
}

TEST(AttitudeFilter, AtRestTheGyroscopeTellsItsBiasOnEveryAxis) {
  AttitudeFilter filter = started();
  const Vec3 bias(0.01, 0.02, -0.015);
  for (int i = 0; i < 2000; ++i) filter.turn(bias, kDt);
  EXPECT_TRUE(filter.at_rest());
  EXPECT_NEAR((filter.bias() - bias).norm(), 0, 1e-4);
}

TEST(AttitudeFilter, AForceThatIsNotGravityAndAFieldThatIsNotTheFirstAreIgnored) {
  AttitudeFilter filter = started(&kField);
  for (int i = 0; i < 1000; ++i) {
    filter.correct_tilt(Vec3(5, 12, 0), kDt);
    filter.correct_yaw(1.5 * kField, kDt);
    filter.correct_yaw(Vec3(2e-5, 4e-5, 0), kDt);
    filter.correct_yaw(Vec3::Constant(NAN), kDt);
    filter.correct_tilt(Vec3::Constant(NAN), kDt);
  }
  EXPECT_EQ(filter.q_MH().coeffs(), Quat::Identity().coeffs());
  EXPECT_EQ(filter.bias(), Vec3::Zero());
}

TEST(AttitudeFilter, YawUncertaintyGrowsWithoutAMagnetometerAndNotWithOne) {
  AttitudeFilter without = started(), with = started(&kField);
  const auto minute = [](AttitudeFilter& f) {
    for (int i = 0; i < 12'000; ++i) {
      f.turn(Vec3::Constant(i % 2 == 0 ? 0.05 : -0.05), kDt);
      f.correct_tilt(f.q_MH() * kForce, kDt);
      f.correct_yaw(f.q_MH() * kField, kDt);
    }
    return f.yaw_sigma();
  };
  const double first = minute(without), second = minute(without);
  EXPECT_GT(first, 1 * kDegree);
  EXPECT_GT(second, 1.8 * first);
  minute(with);
  EXPECT_LT(minute(with), 1.5 * kDegree);
  EXPECT_LT(without.tilt_sigma(), 1 * kDegree);
}

// x = a t^2 / 2, told by both.
TEST(GripObserver, FollowsASteadyAccelerationExactly) {
  GripObserver observer(GripObserverConfig{});
  const Vec3 a(1, -2, 0.5);
  for (int k = 0; k < 8000; ++k) {
    const double t = 1e-3 * k;
    observer.step(a * t * t / 2);
    if (k % 5 == 0 && k > 20) observer.acceleration(6.5, a);
  }
  EXPECT_NEAR((observer.state().v - a * 7.999).norm(), 0, 1e-6);
  EXPECT_NEAR((observer.state().a - a).norm(), 0, 1e-5);
}

TEST(GripObserver, LearnsTheAccelerometersOffset) {
  GripObserver observer(GripObserverConfig{});
  const Vec3 offset(0.3, -0.2, 0.1);
  for (int k = 0; k < 20'000; ++k) {
    observer.step(Vec3(0, 0, 0.12));
    if (k % 5 == 0 && k > 20) observer.acceleration(6, offset);
  }
  EXPECT_NEAR((observer.bias() - offset).norm(), 0, 1e-3);
  EXPECT_NEAR(observer.state().v.norm(), 0, 1e-5);
}

TEST(GripObserver, LeavesOutWhatIsTooOldOrComesTwice) {
  GripObserver observer(GripObserverConfig{});
  for (int k = 0; k < 300; ++k) observer.step(Vec3::Zero());
  observer.acceleration(GripObserver::kTicks, Vec3(9, 9, 9));
  observer.acceleration(-1, Vec3(9, 9, 9));
  observer.acceleration(NAN, Vec3(9, 9, 9));
  EXPECT_EQ(observer.state().a, Vec3::Zero());
  observer.acceleration(5, Vec3::Zero());
  observer.acceleration(5, Vec3(9, 9, 9));
  observer.acceleration(8, Vec3(9, 9, 9));
  EXPECT_EQ(observer.state().a, Vec3::Zero());
}

TEST(GripMotion, SilentEncodersHoldThePlaceAndTheNextOnesStartAtRest) {
  GripMotion motion(GripMotionConfig{});
  TimePoint now{std::chrono::seconds(5)};
  const auto tick = [&](const Vec3* p) -> const GripMotionEstimate& {
    return motion.step(now += std::chrono::milliseconds(1), p);
  };
  Vec3 p(0, 0, 0.12);
  for (int k = 0; k < 500; ++k) p.x() += 1e-4, tick(&p);
  EXPECT_NEAR(tick(&p).V_MH.linear.x(), 0.1, 0.05);
  const Vec3 held = tick(nullptr).X_MH.p;
  EXPECT_EQ(tick(nullptr).V_MH.linear, Vec3::Zero());
  EXPECT_EQ(tick(nullptr).X_MH.p, held);
  p = Vec3(0.03, 0, 0.12);
  EXPECT_EQ(tick(&p).V_MH.linear, Vec3::Zero());
  EXPECT_EQ(tick(&p).X_MH.p, p);
}

TEST(GripMotion, TakesNothingFromTheHeap) {
  GripMotion motion(GripMotionConfig{});
  TimePoint now{std::chrono::seconds(5)};
  const Vec3 p(0, 0, 0.12);
  const auto run = [&] {
    for (int k = 0; k < 3000; ++k) {
      now += std::chrono::milliseconds(1);
      if (k % 5 == 0)
        motion.take({.acceleration = kForce, .magnetic = kField, .time = now.time_since_epoch()},
                    now);
      motion.step(now, &p);
    }
  };
  EXPECT_EQ(allocations_in(run), 0u);
}

}  // namespace
}  // namespace farhand
