#include "slave/sim_arm.hpp"

#include <gtest/gtest.h>

#include <Eigen/LU>
#include <cstdio>
#include <functional>
#include <numbers>

namespace farhand {
namespace {

constexpr Duration kTick = std::chrono::milliseconds(1);

Vec6 degrees(double a, double b, double c, double d, double e, double f) {
  Vec6 q;
  q << a, b, c, d, e, f;
  return q * (std::numbers::pi / 180);
}
const Vec6 kHome = degrees(90, 95, -35, 0, 30, 0);

// A plant and its controller at 1 kHz.
struct Bench {
  using Controller = std::function<Vec6(const RobotReading&)>;
  explicit Bench(const SimArmConfig& config)
      : plant(config), arm(make_arm_dynamics(config.model)) {}

  void run(int ticks, const Controller& controller) {
    for (int k = 0; k < ticks; ++k, now += kTick) {
      reading = plant.read(now);
      ASSERT_TRUE(reading.ok);
      plant.write(now, controller(reading));
    }
    reading = plant.read(now);
  }
  // Weight carried, joints on springs about `q_rest`, and a push of the tool on top.
  Controller hold(const Vec6& q_rest, const Vec3& push = Vec3::Zero()) {
    return [this, q_rest, push](const RobotReading& r) -> Vec6 {
      const Vec6 kp = (Vec6() << 200, 200, 150, 20, 20, 10).finished(), kd = kp / 10;
      const ArmFrames frames = arm_frames(arm, joint_trig(r.q));
      return gravity_torques(arm, r.q) + joint_torques(frames, {push, Vec3::Zero()}) +
             kp.cwiseProduct(q_rest - r.q) - kd.cwiseProduct(r.dq);
    };
  }

  SimArm plant;
  ArmDynamics arm;
  TimePoint now{};
  RobotReading reading;
};

Vec6 nothing(const RobotReading&) {
  return Vec6::Zero();
}

Vec3 tool_position(const SimArmConfig& c) {
  return arm_frames(make_arm_dynamics(c.model), joint_trig(c.q)).X_SE.p;
}

// The world is one plane under the tool at home, `gap` below it.
SimArmConfig over_a_plane(const Surface& like, double gap) {
  SimArmConfig c{.friction = false, .q = kHome};
  c.surfaces.items[0] = like;
  c.surfaces.items[0].shape = Plane{tool_position(c) - Vec3(0, 0, gap), Vec3::UnitZ()};
  c.surfaces.count = 1;
  return c;
}

TEST(SimArm, EnergyIsConservedInAFrictionlessFall) {
  for (const Vec6& start : {kHome, degrees(0, 45, -60, 30, 40, 10), degrees(90, 90, 0, 0, 0, 0)}) {
    Bench b({.friction = false, .q = start});
    const double before = b.plant.truth().energy;
    double worst = 0, fastest = 0;
    for (int k = 0; k < 6000; ++k) {
      b.run(10, nothing);
      const SimArmTruth t = b.plant.truth();
      worst = std::max(worst, std::abs(t.energy - before));
      fastest = std::max(fastest, t.dq.cwiseAbs().maxCoeff());
    }
    std::printf("fall of 60 s: worst energy error %.3g J, up to %.0f rad/s, %.2f steps/ms\n", worst,
                fastest, static_cast<double>(b.plant.status().steps) / 60000);
    EXPECT_LE(worst, 1e-6);
    EXPECT_GT(fastest, 5);
  }
}

TEST(SimArm, PressingOnAPlaneSettlesAtForceOverStiffness) {
  for (const double k : {1e4, 1e5, 1e6}) {
    const SimArmConfig c = over_a_plane({.stiffness = k, .damping = 3e-4 * k}, 1e-4);
    Bench b(c);
    const auto push = b.hold(kHome, Vec3(0, 0, -20));
    b.run(12000, push);
    double least = 1e9, most = 0;
    for (int n = 0; n < 1000; ++n) {
      b.run(1, push);
      const double F = -b.reading.F_E_S.force.z();
      least = std::min(least, F);
      most = std::max(most, F);
    }
    // The force that statics asks for, from the torques alone.
    const SimArmTruth t = b.plant.truth();
    const ArmFrames frames = arm_frames(b.arm, joint_trig(t.q));
    const Vec6 load = t.tau - gravity_torques(b.arm, t.q);
    Mat6 JT;
    for (int i = 0; i < 6; ++i) {
      Wrench unit;
      (i < 3 ? unit.force : unit.torque)[i % 3] = 1;
      JT.col(i) = joint_torques(frames, unit);
    }
    const double F = -Vec6(JT.lu().solve(load))[2];
    const double depth = std::get<Plane>(c.surfaces.items[0].shape).point.z() - t.X_SE.p.z();
    std::printf("k %.0e N/m, plant 1 kHz: %.6f N, ripple %.2g N, depth - F/k %.2g m\n", k, F,
                most - least, depth - F / k);
    EXPECT_GT(F, 15);
    EXPECT_LE(most - least, 1e-9);
    EXPECT_NEAR(depth, F / k, 1e-14 + 1e-12 * F / k + 1e-9 / k);
  }
}

TEST(SimArm, ASurfaceStepsWhenItIsTime) {
  SimArmConfig c = over_a_plane({.stiffness = 1000, .damping = 5}, 0);
  c.surface_steps = {{0, std::chrono::seconds(1), Vec3(0.3, 0, 0.002)},
                     {0, std::chrono::seconds(2), Vec3(0, 0, -0.01)}};
  Bench b(c);
  const auto push = b.hold(kHome, Vec3(0, 0, -5));
  for (const double by : {0.002, -0.01}) {
    b.run(998, push);
    const double before = b.plant.truth().penetration;
    b.run(2, push);
    EXPECT_NEAR(b.plant.truth().penetration - before, by, 1e-4);
  }
}

TEST(SimArm, TheToolSticksBelowTheFrictionConeWithoutCreep) {
  Bench b(over_a_plane({.stiffness = 1e4,
                        .damping = 100,
                        .friction = 0.5,
                        .tangential_stiffness = 1e4,
                        .tangential_damping = 100},
                       0));
  b.run(5000, b.hold(kHome, Vec3(0, 0, -30)));
  const auto lean = b.hold(b.reading.q, Vec3(3, 0, -15));
  b.run(5000, lean);
  const Vec3 before = b.plant.truth().X_SE.p;
  b.run(10000, lean);
  const SimArmTruth t = b.plant.truth();
  const double ratio = t.F_E_S.force.head<2>().norm() / -t.F_E_S.force.z();
  std::printf("stick: tangential/normal %.3f of 0.5, creep in 10 s %.2g m\n", ratio,
              (t.X_SE.p - before).norm());
  EXPECT_GT(ratio, 0.1);
  EXPECT_LT(ratio, 0.5);
  EXPECT_LE((t.X_SE.p - before).norm(), 1e-12);
}

TEST(SimArm, TheToolSlidesAtMuTimesTheNormalForce) {
  Bench b(over_a_plane({.stiffness = 1e4,
                        .damping = 100,
                        .friction = 0.2,
                        .tangential_stiffness = 1e4,
                        .tangential_damping = 100},
                       0));
  b.run(3000, b.hold(kHome, Vec3(0, 0, -20)));
  Vec6 turning = kHome;
  double x = b.plant.truth().X_SE.p.x();
  for (int k = 0; k < 2000; ++k) {
    turning[0] -= 2e-4;  // the whole arm swings about Z, the tool goes along +X
    b.run(1, b.hold(turning, Vec3(0, 0, -20)));
  }
  const SimArmTruth t = b.plant.truth();
  EXPECT_GT(t.X_SE.p.x() - x, 0.05);
  EXPECT_NEAR(t.F_E_S.force.head<2>().norm(), 0.2 * -t.F_E_S.force.z(), 1e-9);
  EXPECT_GT(t.F_E_S.force.x(), 0);
}

TEST(SimArm, AJointSticksBelowItsCoulombTorqueWithoutCreep) {
  Bench b({.q = kHome});
  const auto lean = [&](const RobotReading& r) -> Vec6 {
    return gravity_torques(b.arm, r.q) + 0.8 * (Vec6() << 1, 1, 0.8, 0.3, 0.3, 0.2).finished();
  };
  b.run(5000, lean);
  const Vec6 before = b.plant.truth().q;
  EXPECT_LE((before - kHome).cwiseAbs().maxCoeff(), 1e-3);
  b.run(20000, lean);
  EXPECT_LE((b.plant.truth().q - before).cwiseAbs().maxCoeff(), 1e-13);
}

TEST(SimArm, AJointSlidesAtTheSpeedItsViscousFrictionAllows) {
  Bench b({.q = kHome});
  b.run(5000, [&](const RobotReading& r) -> Vec6 {
    Vec6 tau = b.hold(kHome)(r);
    tau[0] = 2;  // 1 N m of it is Coulomb's, the rest 0.5 N m s times the speed
    return tau;
  });
  EXPECT_NEAR(b.plant.truth().dq[0], 2, 1e-6);
}

TEST(SimArm, FrictionOnlyTakesEnergy) {
  for (const double rate : {1000.0, 4000.0}) {
    Bench b({.rate_hz = rate, .q = kHome});
    double last = b.plant.truth().energy;
    for (int k = 0; k < 10000; ++k) {
      b.run(1, nothing);
      const double e = b.plant.truth().energy;
      ASSERT_LE(e, last + 1e-4) << "at " << k << " ms";  // a bristle stores 1e-4 J at most
      last = e;
    }
    EXPECT_LE(b.plant.truth().dq.cwiseAbs().maxCoeff(), 1e-6);
  }
}

TEST(SimArm, StepsAreEqualAndAsNearToTheRateAsDividesTheTime) {
  SimArm plant({.rate_hz = 4000, .q = kHome});
  TimePoint now{};
  plant.read(now);
  EXPECT_EQ(plant.status().steps, 0u);
  plant.read(now += kTick);
  EXPECT_EQ(plant.status().steps, 4u);
  plant.read(now += std::chrono::microseconds(1400));
  EXPECT_EQ(plant.status().steps, 10u);
  plant.read(now += std::chrono::nanoseconds(1));
  EXPECT_EQ(plant.status().steps, 11u);
}

TEST(SimArm, TimeThatStandsStillOrRunsBackDoesNothing) {
  SimArm plant({.q = kHome});
  TimePoint now{};
  plant.read(now);
  plant.read(now += 10 * kTick);
  const Vec6 q = plant.truth().q;
  plant.read(now);
  plant.write(now - 5 * kTick, Vec6::Zero());
  EXPECT_EQ(plant.truth().q, q);
  EXPECT_EQ(plant.status().steps, 10u);
}

TEST(SimArm, ALateCallSimulatesABoundedTimeCountsTheOtherAndTheArmRests) {
  SimArm plant({.q = kHome});
  plant.read(TimePoint{});
  plant.read(TimePoint{} + SimArm::kMaxCatchUp);
  EXPECT_GT(plant.truth().dq.norm(), 0.1);  // it falls
  plant = SimArm({.q = kHome});
  plant.read(TimePoint{});
  plant.read(TimePoint{} + std::chrono::seconds(3600));
  EXPECT_EQ(plant.truth().dq, Vec6(Vec6::Zero()));
  EXPECT_EQ(plant.status().steps, 50u);
  EXPECT_EQ(plant.status().skipped, std::chrono::seconds(3600) - SimArm::kMaxCatchUp);
}

TEST(SimArm, TorqueIsClampedAtTheDrivesAndNonFiniteTorqueBecomesZero) {
  SimArm plant({.q = kHome});
  plant.write({}, Vec6::Constant(1e6));
  EXPECT_EQ(plant.truth().tau, (Vec6() << 60, 60, 40, 15, 15, 8).finished());
  plant.write({}, Vec6::Constant(-1e6));
  EXPECT_EQ(plant.truth().tau, -(Vec6() << 60, 60, 40, 15, 15, 8).finished());
  Vec6 bad = Vec6::Ones();
  bad[3] = NAN;
  plant.write({}, bad);
  EXPECT_EQ(plant.truth().tau, Vec6::Zero());
  EXPECT_EQ(plant.status().bad_torques, 1u);
}

TEST(SimArm, EncodersRoundAndTheirDifferenceFollowsTheSpeed) {
  const double quantum = 1e-5;
  Bench exact({.q = kHome});
  Bench coded({.q = kHome, .encoder_quantum_rad = quantum, .velocity = VelocitySource::encoder});
  double error = 0;
  for (int k = 0; k < 300; ++k) {
    exact.run(1, nothing);
    coded.run(1, nothing);
    EXPECT_LE((coded.reading.q - exact.reading.q).cwiseAbs().maxCoeff(), quantum / 2 + 1e-12);
    EXPECT_NEAR(
        (coded.reading.q / quantum - (coded.reading.q / quantum).array().round().matrix()).norm(),
        0, 1e-6);
    error = std::max(error, (coded.reading.dq - exact.reading.dq).cwiseAbs().maxCoeff());
  }
  EXPECT_GT(exact.reading.dq.cwiseAbs().maxCoeff(), 0.3);
  EXPECT_LT(error, 0.2);  // 1.6 ms of filter and half a sample, at up to 50 rad/s^2
  EXPECT_GT(error, 0);
}

TEST(SimArm, SensorReadsContactToolWeightBiasAndNoise) {
  SimArmConfig c = over_a_plane({.stiffness = 1e4}, -0.001);
  c.sensor = {.bias_E = {Vec3(1, 2, 3), Vec3(0.1, 0.2, 0.3)},
              .tool_mass_kg = 0.2,
              .tool_com_E = Vec3(0, 0, -0.03)};
  SimArm plant(c);
  const Wrench F = plant.read({}).F_E_S;
  const SimArmTruth t = plant.truth();
  EXPECT_NEAR(t.F_E_S.force.z(), -10, 1e-9);
  const Wrench rest = F - t.F_E_S - t.X_SE.R * c.sensor.bias_E;
  EXPECT_NEAR((rest.force - Vec3(0, 0, 0.2 * 9.81)).norm(), 0, 1e-12);  // it carries the tool
  EXPECT_NEAR((rest.torque - Vec3(0, -0.03, 0).cross(Vec3(0, 0, 0.2 * 9.81))).norm(), 0, 1e-12);
}

TEST(SimArm, NoiseHasItsSizeAndItsSeed) {
  SimArmConfig c{.q = kHome,
                 .sensor = {.force_noise_newton = 0.03, .torque_noise_newton_metre = 0.002},
                 .seed = 9};
  SimArm a(c), b(c);
  c.seed = 10;
  SimArm other(c);
  double force = 0, torque = 0;
  constexpr int kReadings = 10000;
  for (int k = 0; k < kReadings; ++k) {
    const Wrench F = a.read({}).F_E_S;
    ASSERT_EQ(F.force, b.read({}).F_E_S.force);
    ASSERT_NE(F.force, other.read({}).F_E_S.force);
    force += F.force.squaredNorm() / 3;
    torque += F.torque.squaredNorm() / 3;
  }
  EXPECT_NEAR(std::sqrt(force / kReadings), 0.03, 0.0005);
  EXPECT_NEAR(std::sqrt(torque / kReadings), 0.002, 0.00004);
}

TEST(SimArm, SameInputsGiveTheSameBits) {
  const SimArmConfig c = over_a_plane({.stiffness = 1e4, .friction = 0.5}, 0.01);
  Bench a(c), b(c);
  a.run(500, nothing);
  b.run(500, nothing);
  EXPECT_EQ(a.plant.truth().q, b.plant.truth().q);
  EXPECT_EQ(a.plant.truth().dq, b.plant.truth().dq);
}

TEST(SimArm, ABrokenStateIsReportedNotReturned) {
  SimArm plant({.q = Vec6::Constant(NAN)});
  plant.read({});
  const RobotReading r = plant.read(TimePoint{} + kTick);
  EXPECT_FALSE(r.ok);
  EXPECT_EQ(r.q, Vec6::Zero());
}

}  // namespace
}  // namespace farhand
