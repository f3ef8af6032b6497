// 10 km from the origin: every stage that takes a position, against itself beside the origin. There
// a double is known to half of 2^-39 m, and this is all that may be lost: each bound follows from
// how often a stage rounds a position and what it multiplies the error by.
#include <gtest/gtest.h>

#include <cmath>
#include <cstdio>
#include <functional>

#include "common/random.hpp"
#include "master/device_observer.hpp"
#include "master/guidance.hpp"
#include "master/position_control.hpp"
#include "master/robot_coupling.hpp"
#include "slave/boundary.hpp"
#include "slave/contact.hpp"
#include "slave/slave.hpp"

namespace farhand {
namespace {

const Vec3 kFar(1e4, -1e4, 1e4);
constexpr double kRound = 0x1p-40;  // [m] half of the last digit between 8192 and 16384 m
const double kVector = std::sqrt(3) * kRound;
constexpr double kTs = 0.001;
constexpr int kTicks = 2000;
constexpr double kOwn = 1 + 1e-9;  // relative, for the arithmetic beside the origin

// The hand's way, smooth, some centimetres about `middle`.
Vec3 way(double t, const Vec3& middle) {
  return middle + 0.03 * Vec3(std::sin(3 * t), std::cos(2 * t) - 1, std::sin(5 * t + 0.3));
}

Pose turned(const Vec3& p, double angle) {
  return {rotation(angle * Vec3(0.3, -0.5, 0.8)), p};
}

void report(const char* stage, double lost, double bound, const char* unit) {
  std::printf("%-44s loses %.1e %s, bound %.1e\n", stage, lost, unit, bound);
  EXPECT_GT(lost, 0) << "the offset did not reach " << stage;
  EXPECT_LE(lost, bound * kOwn) << stage;
}

// Two positions of the handle and two of the tool are rounded.
TEST(FarFromTheOrigin, Mapping) {
  const WorkspaceConfig config{.R_SM = twin_delta_axes(), .scale = 2};
  const Vec3 p_MH(0.18, 0.01, 0.02), p_SE(0.1, 0.3, 0.4);
  WorkspaceState near, far;
  couple(config, near, turned(p_MH, 0.1), turned(p_SE, 0.7));
  couple(config, far, turned(p_MH + kFar, 0.1), turned(p_SE + kFar, 0.7));
  LimitSet set = kLimitNone;
  double lost = 0, lost_back = 0;
  for (int k = 0; k < kTicks; ++k) {
    const double t = k * kTs;
    const Pose a = follow(config, near, turned(way(t, p_MH), t), set);
    const Pose b = follow(config, far, turned(way(t, p_MH) + kFar, t), set);
    EXPECT_EQ(a.R, b.R);
    lost = std::max(lost, ((b.p - kFar) - a.p).cwiseAbs().maxCoeff());
    const Vec3 back = as_handle(config, far, b).p - kFar;
    lost_back = std::max(lost_back, (back - way(t, p_MH)).cwiseAbs().maxCoeff());
  }
  report("workspace, scale 2", lost, 2 * config.scale * kRound + 2 * kRound, "m");
  // There and back: the tool's place is rounded once, the handle's twice as read, once as given.
  report("workspace, back to the handle", lost_back, 2 * kRound / config.scale + 4 * kRound, "m");
}

// The slave's whole tick with the handle far away: the mapping's loss, through the arm's inverse.
TEST(FarFromTheOrigin, TheSlavesTick) {
  SlaveConfig config;
  config.workspace.R_SM = twin_delta_axes();
  Slave near(config), far(config);
  RobotReading robot{.ok = true, .q = kTeleopHome}, robot_far = robot;
  MasterToSlave in, in_far;
  TimePoint now{std::chrono::seconds(1)};
  double lost = 0, gain = 0;
  for (int k = 0; k < kTicks; ++k, now += std::chrono::milliseconds(1)) {
    in.mode = k < 2 ? Mode::ready : Mode::engaged;
    in.dead_man = k >= 2;
    in.p_MH = way(k * kTs, Vec3(0.18, 0, 0));
    in_far = in;
    in_far.p_MH += kFar;
    const SlaveTick& a = near.tick(now, {&in, true, {}, true}, robot);
    const SlaveTick& b = far.tick(now, {&in_far, true, {}, true}, robot_far);
    EXPECT_EQ(a.coupled, k >= 2);
    lost = std::max(lost, (a.q_cmd - b.q_cmd).cwiseAbs().maxCoeff());
    const ArmKinematics at = kinematics(config.arm, a.q_cmd);
    Vec6 sum = Vec6::Zero();  // of what a metre along each axis turns the joints by
    for (int i = 0; i < 3; ++i) {
      Twist unit;
      unit.linear[i] = 1;
      sum += joint_rates(config.arm, at, unit).dq.cwiseAbs();
    }
    gain = std::max(gain, sum.maxCoeff());
    robot.q = a.q_cmd, robot_far.q = b.q_cmd;
  }
  report("slave, handle far away", lost, gain * 2 * kRound + 1e-14, "rad");
}

// Both places are rounded, so a depth is wrong by up to twice kVector; so is a direction, over the
// distance it is taken from.
TEST(FarFromTheOrigin, Guidance) {
  const Vec3 middle(0.18, 0, 0), n = Vec3(0.3, -0.5, 0.8).normalized();
  const auto shape_at = [&](int kind, const Vec3& offset) -> decltype(Fixture::shape) {
    const Vec3 p = middle + offset;
    if (kind < 2) return PlaneFixture{p, n, kind == 1};
    if (kind == 2) return AxisFixture{p, n};
    return SphereFixture{p, 0.015, SphereFixture::Keep(kind - 3)};
  };
  const char* names[] = {"guidance, wall",          "guidance, two-sided plane", "guidance, axis",
                         "guidance, inside a ball", "guidance, outside a ball",  "guidance, notch"};
  for (int kind = 0; kind < 6; ++kind) {
    const Fixture near{.shape = shape_at(kind, Vec3::Zero()), .max_force = 1e3};
    Fixture far = near;
    far.shape = shape_at(kind, kFar);
    double lost = 0, fastest = 0, furthest = 0, nearest = 1;
    for (int k = 0; k < kTicks; ++k) {
      const Vec3 p = way(k * kTs, middle), v = (way((k + 1) * kTs, middle) - p) / kTs;
      lost = std::max(lost, (fixture_force(far, p + kFar, v) - fixture_force(near, p, v)).norm());
      fastest = std::max(fastest, v.norm());
      furthest = std::max(furthest, (p - middle).norm());
      nearest = std::min(nearest, (p - middle).norm());
    }
    const double force = near.stiffness * furthest + near.damping * fastest;
    // Damping sets in over a millimetre of depth; the notch's share falls by 2 distance / radius^2.
    const double damping = near.damping * fastest / 0.001, turning = force / nearest;
    const double fading = 2 * furthest / (0.015 * 0.015) * force;
    report(names[kind], lost, 2 * kVector * (near.stiffness + damping + turning + fading), "N");
  }
}

TEST(FarFromTheOrigin, RobotCoupling) {
  const RobotCouplingConfig config;
  SlaveToMaster near{.has_robot = true}, far;
  HandlePose handle, handle_far;
  double lost = 0;
  for (int k = 0; k < kTicks; ++k) {
    handle.X_MH.p = way(k * kTs, Vec3::Zero());
    near.p_MR = way(k * kTs - 0.02, Vec3::Zero());
    handle_far = handle, far = near;
    handle_far.X_MH.p += kFar, far.p_MR += kFar;
    lost = std::max(
        lost,
        (couple(config, handle_far, {}, far) - couple(config, handle, {}, near)).force.norm());
  }
  report("robot coupling", lost, config.stiffness * 2 * kVector, "N");
}

// Set point and grip are rounded. A derivative sees two samples, an integral their sum; a target
// that travels is rounded at every step of its way.
TEST(FarFromTheOrigin, PositionControl) {
  for (const bool safe : {false, true}) {
    const Vec3 start(0, 0, 0.12), goal(0.03, -0.02, 0.11);
    PositionControlConfig near, far;
    near.set_points = {{std::chrono::milliseconds(300), goal}};
    near.max_force = 100;
    if (safe) near.safe = SafeMotion{};
    far = near;
    far.set_points[0].p_MH += kFar;
    PositionControl a(near, kTs), b(far, kTs);
    double lost = 0;
    TimePoint now{};
    LimitSet set = kLimitNone;
    for (int k = 0; k < kTicks; ++k, now += std::chrono::milliseconds(1)) {
      const Vec3 p = way(k * kTs, start);
      const Vec3 f = a.step(now, {.p_MH = p}, set);
      lost = std::max(lost, (b.step(now, {.p_MH = p + kFar}, set) - f).norm());
    }
    const double steps = safe ? (goal - start).norm() / (0.1 * kTs) : 0;
    const double error = (2 + steps) * kVector;
    const PidConfig& pid = near.pid;
    report(safe ? "position control, safe motion" : "position control", lost,
           pid.kp * error + pid.ki * kTicks * kTs * error + pid.kd / kTs * 4 * kVector, "N");
  }
}

TEST(FarFromTheOrigin, Pid) {
  const PidConfig config{.kp = 150, .ki = 13, .kd = 5};
  const Pid pid = make_pid(config, kTs);
  PidState near, far;
  double lost = 0;
  for (int k = 0; k < kTicks; ++k) {
    const double r = std::sin(0.002 * k), y = 0.9 * std::sin(0.002 * k - 0.1);
    const double u = step(pid, near, r, y);
    lost = std::max(lost, std::abs(step(pid, far, r + 1e4, y + 1e4) - u));
  }
  const double error = 2 * kRound;
  report("PID, 150, 13, 5", lost,
         config.kp * error + config.ki * kTicks * kTs * error + config.kd / kTs * 2 * error, "");
}

// Differences of positions, each rounded once: the filter passes no more than its first gain of it.
TEST(FarFromTheOrigin, HandleVelocity) {
  HandleVelocity near(60, kTs), far(60, kTs);
  double lost = 0;
  for (int k = 0; k < kTicks; ++k) {
    Pose X{Mat3::Identity(), way(k * kTs, Vec3::Zero())};
    const Vec3 v = near.step(X).linear;
    X.p += kFar;
    lost = std::max(lost, (far.step(X).linear - v).cwiseAbs().maxCoeff());
  }
  report("handle velocity, 60 Hz", lost, 2 * kRound * low_pass_gain(60, kTs) / kTs, "m/s");
}

// Linear without friction: its answer to a place that is wrong once, summed over all later ticks,
// is what an error of 1 m in every tick can do at most; as much again comes from the first place,
// from which all others are counted.
TEST(FarFromTheOrigin, DeviceObserver) {
  DeviceModel model;
  model.translation.friction = 0;
  const auto run = [&](const std::function<Vec3(int)>& place, int ticks) {
    DeviceObserver observer(model, {}, kTs);
    std::vector<DeviceMotion> out;
    HandlePose pose;
    for (int k = 0; k < ticks; ++k) {
      pose.X_MH.p = place(k);
      out.push_back(observer.step(pose, DeviceAxes::Zero()));
    }
    return out;
  };
  const auto once = run([](int k) { return Vec3(k == 1 ? 1.0 : 0.0, 0, 0); }, kTicks);
  const auto still = run([](int) { return Vec3(0, 0, 0); }, kTicks);
  const auto near = run([](int k) { return way(k * kTs, Vec3::Zero()); }, kTicks);
  const auto far = run([](int k) { return Vec3(way(k * kTs, Vec3::Zero()) + kFar); }, kTicks);
  double lost_v = 0, lost_a = 0, lost_rest = 0, sum_v = 0, sum_a = 0, sum_rest = 0;
  for (std::size_t k = 0; k < near.size(); ++k) {
    const auto worst = [](const DeviceAxes& a, const DeviceAxes& b) {
      return (a - b).abs().maxCoeff();
    };
    lost_v = std::max(lost_v, worst(far[k].v, near[k].v));
    lost_a = std::max(lost_a, worst(far[k].a, near[k].a));
    lost_rest = std::max(lost_rest, worst(far[k].rest, near[k].rest));
    sum_v += worst(once[k].v, still[k].v);
    sum_a += worst(once[k].a, still[k].a);
    sum_rest += worst(once[k].rest, still[k].rest);
  }
  report("device observer, velocity", lost_v, 2 * sum_v * kRound, "m/s");
  report("device observer, acceleration", lost_a, 2 * sum_a * kRound, "m/s^2");
  report("device observer, rest", lost_rest, 2 * sum_rest * kRound, "N");
}

// As in guidance; a bristle is as long as four rounded places say, and its friction is capped by
// the normal force.
TEST(FarFromTheOrigin, Contact) {
  const Vec3 middle(0.1, 0.3, 0.4);
  const auto shape_at = [&](int kind, const Vec3& offset) -> Shape {
    const Vec3 p = middle + offset;
    if (kind == 0) return Plane{p, Vec3(0.3, -0.5, 0.8).normalized()};
    if (kind == 1) return Sphere{p, 0.02};
    return Box{.X_SB = {rotation(Vec3(0.3, -0.5, 0.9)), p},
               .half_extents = Vec3(0.02, 0.015, 0.025),
               .edge_radius = 0.005};
  };
  const char* names[] = {"contact, plane", "contact, ball", "contact, box"};
  for (int kind = 0; kind < 3; ++kind) {
    Surfaces near, far;
    near.count = 1;
    near.items[0] = {.shape = shape_at(kind, Vec3::Zero()),
                     .stiffness = 1e4,
                     .friction = 0.3,
                     .tangential_stiffness = 1e4};
    far = near;
    far.items[0].shape = shape_at(kind, kFar);
    ContactState a, b;
    double lost = 0, lost_torque = 0, strongest = 0;
    int touched = 0;
    for (int k = 0; k < kTicks; ++k) {
      Tip tip{turned(way(k * kTs, middle), k * kTs), {}, 0.004}, tip_far = tip;
      tip_far.X_SE.p += kFar;
      update_anchors(near, a, tip);
      update_anchors(far, b, tip_far);
      const Wrench F = contact_wrench(near, a, tip), G = contact_wrench(far, b, tip_far);
      lost = std::max(lost, (G - F).force.norm());
      lost_torque = std::max(lost_torque, (G - F).torque.norm());
      strongest = std::max(strongest, F.force.norm());
      touched += F.force.norm() > 0;
    }
    EXPECT_GT(touched, kTicks / 20) << names[kind];
    const Surface& s = near.items[0];
    const double turning = strongest / 0.004;  // the smallest distance a direction is taken from
    const double bound =
        kVector * (2 * s.stiffness * (1 + s.friction) + 4 * s.tangential_stiffness + 2 * turning);
    report(names[kind], lost, bound, "N");
    // The point that touches is rounded, too.
    std::printf("%-44s loses %.1e N m\n", "  its torque", lost_torque);
    EXPECT_LE(lost_torque, 0.004 * bound + 2 * kVector * strongest);
  }
}

// A wish 10 km beyond the reach is held where one of 100 m in the same direction is.
TEST(FarFromTheOrigin, Boundary) {
  const ArmGeometry arm;
  const JointLimits joints;
  const Mat3 R = forward(arm, kTeleopHome).R;
  const auto wish = [&](double distance, const Vec3& direction) -> Pose {
    return {R, Vec3(0, 0, arm.d1) + distance * direction + arm.d6 * R.col(2)};
  };
  double lost = 0;
  Random random(4);
  for (int k = 0; k < 200; ++k) {
    const Vec3 direction =
        Vec3(0.3 * (random.uniform() - 0.5), 1, 0.3 + 0.3 * random.uniform()).normalized();
    BoundaryHold hold[2];
    for (const int i : {0, 1}) {
      Boundary boundary({.reach_margin = 0.005}, arm, joints);
      boundary.couple(kTeleopHome);
      hold[i] = boundary.step(wish(i == 0 ? 1e2 : 1e4, direction));
      ASSERT_EQ(hold[i].status, Status::ok);
      EXPECT_TRUE(hold[i].held);
      EXPECT_NEAR(boundary.F_E_S().force.norm(), BoundaryConfig{}.limits.force_step, 1e-12);
    }
    lost = std::max(lost, (hold[1].X_SE.p - hold[0].X_SE.p).norm());
  }
  // The wish, the wrist centre, the way from it to the edge and the held place are rounded.
  report("boundary, a wish 10 km away", lost, 4 * kVector, "m");
}

}  // namespace
}  // namespace farhand
