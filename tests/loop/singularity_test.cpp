// The whole product, a handle that follows a path exactly: the tool is carried at its full
// permitted speed through each of the arm's singularities and closely by them. No joint exceeds its
// rate, and at rest again the tool is where a passage that keeps off leaves it.
#include <gtest/gtest.h>

#include <numbers>

#include "tests/loop/checkers.hpp"
#include "tests/loop/loopback.hpp"
#include "tests/support/scene_edits.hpp"

namespace farhand {
namespace {

constexpr double kDegree = std::numbers::pi / 180;
constexpr double kTs = 0.001;
constexpr double kPress = 0.4, kGo = 0.8, kRest = 3;  // [s] dead-man, begin of the motion, rest
constexpr double kRounding = 1e-9;                    // relative, of the limiter
// Of the rate limit, what the links' weight adds where nothing compensates it: measured.
constexpr double kWeight = 0.02;
constexpr double kRecovery = 0.2;  // [s]

// The handle turns and moves by these, about and along axes of S, in a minimum-jerk move, stays,
// and comes back; all of it `times` times.
struct Passage {
  Vec3 by_S = Vec3::Zero();    // [m]
  Vec3 turn_S = Vec3::Zero();  // rotation vector
  double lasting = 0.1;        // [s]
  int times = 1;
};

// 0 to 1 and back.
double share(const Passage& p, double t) {
  const double gone = (t - kGo) / p.lasting;
  if (gone <= 0) return 0;
  const int move = static_cast<int>(gone);
  if (move >= p.times) return p.times % 2;
  const double x = gone - move, s = x * x * x * (10 - 15 * x + 6 * x * x);
  return move % 2 == 0 ? s : 1 - s;
}

double end_of(const Passage& p) {
  return kGo + p.times * p.lasting + kRest;
}

HandleReading at(const MasterConfig& m, const Mat3& R_SM, const Passage& p, double t) {
  HandleReading r{.ok = true, .dead_man = t > kPress};
  const double s = share(p, t);
  const Vec3 move = R_SM.transpose() * (s * p.by_S - 0.5 * p.by_S);
  if (const auto* f = std::get_if<FalconHandle>(&m.handle)) {
    const auto angles = motor_angles(f->geometry, Vec3(Vec3(0, 0, 0.115) + move));
    EXPECT_EQ(angles.status, Status::ok);
    r.theta.head<3>() = angles.theta1;
    return r;
  }
  TwinDeltaPose pose;
  pose.p_MH += move;
  pose.axis = rotation(R_SM.transpose() * (s * p.turn_S - 0.5 * p.turn_S)) * pose.axis;
  const auto angles = motor_angles(kTwinDelta, pose);
  EXPECT_EQ(angles.status, Status::ok);
  r.theta = angles.theta1;
  return r;
}

ReplayHand hand(const MasterConfig& m, const Mat3& R_SM, const Passage& p) {
  std::vector<HandleReading> readings;
  for (int k = 0; k < static_cast<int>(end_of(p) / kTs) + 10; ++k)
    readings.push_back(at(m, R_SM, p, k * kTs));
  return ReplayHand(std::move(readings));
}

struct Outcome {
  double tool_speed = 0;          // [m/s] and
  double turn_rate = 0;           // [rad/s], largest of the target
  double nearest = 1;             // least measure of the singularity that is met
  double command = 0, truth = 0;  // largest joint rates, shares of their limits
  double largest_error = 0;       // [m] of the command against the wish, on the way
  double recovered = 0;  // [s] after the end of the motion: the command is where it shall be
  double command_error = 0,
         command_turn = 0;               // at rest, of the command against the wish [m], [rad]
  double tool_error = 0, tool_turn = 0;  // at rest, of the true tool
};

enum class Met { wrist, elbow, shoulder };

double measure(const ArmSingularity& s, Met met) {
  return met == Met::wrist ? s.wrist : met == Met::elbow ? s.elbow : s.shoulder;
}

Scene scene_of(const std::string& name, const Vec6& q_start, bool boundary) {
  Scene scene = shipped(name);
  auto& arm = *scene.proto.mutable_slave()->mutable_sim_arm();
  arm.clear_surface();
  arm.set_encoder_step_rad(0);  // so that the arm starts where it is told
  arm.clear_start_deg();
  for (const double q : q_start) arm.add_start_deg(q / kDegree);
  if (boundary) scene.proto.mutable_slave()->mutable_boundary();
  return scene;
}

Outcome run(const Scene& scene, const Passage& p, Met met) {
  const SlaveConfig s = slave_config(scene.proto);
  Loopback loop(scene,
                {.duration_s = end_of(p),
                 .device = AnyDevice(hand(master_config(scene.proto), s.workspace.R_SM, p))});
  Checkers checkers(loop);
  Outcome o;
  Vec6 q_cmd = Vec6::Zero();
  Pose wish;
  bool started = false;
  loop.on_master = [&](const MasterTick& t) { checkers.check(t); };
  loop.on_slave = [&](const SlaveTick& t) {
    checkers.check(t);
    const double now = seconds(t.now - loop.start());
    const SimArmTruth truth = std::get<SimArm>(*loop.robot()).truth();
    const auto rate = [&](const Vec6& dq) {
      return dq.cwiseAbs().cwiseQuotient(s.joints.speed).maxCoeff();
    };
    o.truth = std::max(o.truth, rate(truth.dq));
    if (started) o.command = std::max(o.command, rate((t.q_cmd - q_cmd) / s.Ts));
    const Pose& target = loop.slave()->workspace().X_SE_target;
    if (started && t.coupled && now > kGo) {
      o.tool_speed = std::max(o.tool_speed, (target.p - wish.p).norm() / s.Ts);
      o.turn_rate =
          std::max(o.turn_rate, rotation_vector(target.R * wish.R.transpose()).norm() / s.Ts);
    }
    started = true, q_cmd = t.q_cmd, wish = target;
    const ArmKinematics command = kinematics(s.arm, t.q_cmd);
    o.nearest = std::min(o.nearest, measure(command.singularity, met));
    o.command_error = (command.X_SE.p - wish.p).norm();
    o.command_turn = rotation_vector(command.X_SE.R * wish.R.transpose()).norm();
    o.tool_error = (truth.X_SE.p - wish.p).norm();
    o.tool_turn = rotation_vector(truth.X_SE.R * wish.R.transpose()).norm();
    o.largest_error = std::max(o.largest_error, o.command_error);
    if (o.command_error + o.command_turn > 1e-9) o.recovered = now - (end_of(p) - kRest);
  };
  loop.run();
  EXPECT_GT(loop.slave()->workspace().coupled, 0);
  EXPECT_EQ(checkers.count(), 0u);
  for (const Violation& v : checkers.first()) ADD_FAILURE() << v.at_s << " s: " << v.what;
  return o;
}

// The worst of several runs.
void add(Outcome& worst, const Outcome& o) {
  for (const auto member :
       {&Outcome::tool_speed, &Outcome::turn_rate, &Outcome::command, &Outcome::truth,
        &Outcome::largest_error, &Outcome::recovered, &Outcome::command_error,
        &Outcome::command_turn, &Outcome::tool_error, &Outcome::tool_turn})
    worst.*member = std::max(worst.*member, o.*member);
  worst.nearest = std::min(worst.nearest, o.nearest);
}

void print(const std::string& what, const Outcome& o) {
  std::printf(
      "%s: %.2f m/s, %.0f deg/s, nearest %.0e; joint rates at most %.3f of their limits commanded, "
      "%.3f true; command up to %.0f mm off, right %.3f s after the motion's end; at rest command "
      "%.0e m %.0e rad, tool %.3f mm %.2f mrad off\n",
      what.c_str(), o.tool_speed, o.turn_rate / kDegree, o.nearest, o.command, o.truth,
      o.largest_error * 1e3, o.recovered, o.command_error, o.command_turn, o.tool_error * 1e3,
      o.tool_turn * 1e3);
}

// Where the motion begins, so that its middle is the pose of `q` missed by `aside` (S axes) and
// turned by `tilt`.
Vec6 start_of(const Passage& p, const Vec6& q, const Vec3& aside, const Vec3& tilt, double scale) {
  Pose X = forward(ArmGeometry{}, q);
  X.p += aside - 0.5 * scale * p.by_S;
  X.R = rotation(tilt) * rotation(-0.5 * p.turn_S) * X.R;
  const ArmInverse all = inverse_all(ArmGeometry{}, X, q);
  EXPECT_EQ(all.status, Status::ok);
  Vec6 best = Vec6::Constant(1e9);
  for (const Vec6& row : all.rows) {
    const Vec6 turns = ((q - row) / (2 * std::numbers::pi)).array().round();
    const Vec6 near = row + 2 * std::numbers::pi * turns;
    if ((near - q).norm() < (best - q).norm()) best = near;
  }
  return best;
}

struct Way {
  Vec6 q;            // in the singularity, or where the same motion keeps off
  Passage passage;   // its middle is there
  Vec3 aside, tilt;  // but for this
};

struct Setting {
  const char* scene;
  bool boundary;
};
constexpr Setting kSettings[] = {{"minimal", false},         {"minimal", true},
                                 {"twin_delta_free", false}, {"twin_delta_free", true},
                                 {"falcon_arm", false},      {"falcon_arm", true}};

bool turns(const Setting& s) {
  return std::string(s.scene) != "falcon_arm";
}

bool compensated(const Setting& s) {
  return std::string(s.scene) != "minimal";
}

Outcome worst_of(const Setting& s, const std::vector<Way>& ways, Met met) {
  Outcome worst;
  for (const Way& w : ways) {
    if (w.passage.turn_S.norm() > 0 && !turns(s)) continue;
    const Vec6 start = start_of(w.passage, w.q, w.aside, w.tilt, 1);
    add(worst, run(scene_of(s.scene, start, s.boundary), w.passage, met));
  }
  return worst;
}

// What Coulomb friction holds a joint off its command by, through the tool's levers: as far as a
// servo brings an arm that rests.
std::pair<double, double> dead_band(const Setting& s, const Vec6& q) {
  const SlaveConfig c = slave_config(scene_of(s.scene, q, s.boundary).proto);
  const ArmJacobian J = jacobian(c.arm, q);
  double place = 0, turn = 0;
  for (int i = 0; i < 6; ++i) {
    const double off = c.model.links[i].coulomb / joint_gains(c.servo, c.servo.inertia[i], 1e9).kp;
    place += off * J.linear.col(i).norm();
    turn += off;
  }
  return {place, turn};
}

void expect_passed(const std::string& name, const std::vector<Way>& through,
                   const std::vector<Way>& off, Met met, double near, double true_rate) {
  for (const Setting& s : kSettings) {
    const std::string what = name + ", " + s.scene + (s.boundary ? " with boundary" : "");
    const Outcome o = worst_of(s, through, met), reference = worst_of(s, off, met);
    print(what, o);
    std::printf("  the same motion elsewhere: true joint rates %.3f, tool %.3f mm %.2f mrad off\n",
                reference.truth, reference.tool_error * 1e3, reference.tool_turn * 1e3);
    EXPECT_LE(o.nearest, near) << what;
    EXPECT_GE(o.tool_speed, 0.99) << what;
    EXPECT_LE(o.command, 1 + kRounding) << what;
    EXPECT_LE(o.truth, true_rate + (compensated(s) ? 0 : kWeight)) << what;
    EXPECT_LE(o.recovered, kRecovery) << what;
    EXPECT_LE(o.command_error, 1e-12) << what;
    EXPECT_LE(o.command_turn, 1e-12) << what;
    const auto [place, turn] = dead_band(s, through[0].q);
    EXPECT_LE(o.tool_error, place) << what;
    EXPECT_LE(o.tool_turn, turn) << what;
    EXPECT_GT(reference.nearest, 2 * near) << what;
  }
}

// Straight through theta5 = 0, 1 mm and 0.1 mrad beside it, once, and there, back and there;
// moved at 1 m/s, and turned at 360 deg/s.
TEST(Singularity, TheWristIsPassedAtFullSpeed) {
  const auto ways = [](double q5) {
    std::vector<Way> out;
    for (const double q4 : {0.0, 170.0}) {
      const Vec6 q = joints_from_degrees({80, 95, -35, q4, q5, 20});
      const Vec3 side = Vec3::UnitX(), up = forward(ArmGeometry{}, q).R.col(2).cross(side);
      for (const int times : {1, 3}) {
        const Passage move{.by_S = 0.06 * up.normalized(), .lasting = 0.1, .times = times};
        const Passage turn{.turn_S = 40 * kDegree * side, .lasting = 0.18, .times = times};
        out.push_back({q, move, Vec3::Zero(), Vec3::Zero()});
        out.push_back({q, move, 1e-3 * side, Vec3::Zero()});
        out.push_back({q, move, Vec3::Zero(), 1e-4 * Vec3::UnitZ()});
        out.push_back({q, turn, Vec3::Zero(), Vec3::Zero()});
        out.push_back({q, turn, Vec3::Zero(), 1e-4 * Vec3::UnitZ()});
      }
    }
    return out;
  };
  expect_passed("wrist", ways(0), ways(50), Met::wrist, 5e-3, 1);
}

// The wrist centre straight over axis 1, and 1 mm and 0.1 mm beside it.
TEST(Singularity, TheShoulderIsPassedAtFullSpeed) {
  const auto ways = [](double back) {
    const ArmGeometry g;
    Vec6 q;
    q << 1.2, 0, 0.6, 0.3, 0.7, -0.2;
    q[1] = std::atan2(g.d4 * std::cos(q[2]), g.a2 + g.d4 * std::sin(q[2])) + std::numbers::pi / 2 -
           back;
    const Vec3 ahead(std::cos(q[0]), std::sin(q[0]), 0), side(-ahead.y(), ahead.x(), 0);
    std::vector<Way> out;
    for (const double aside : {0.0, 1e-3, 1e-4})
      for (const int times : {1, 3})
        out.push_back({q,
                       {.by_S = 0.06 * ahead, .lasting = 0.1, .times = times},
                       aside * side,
                       Vec3::Zero()});
    return out;
  };
  expect_passed("shoulder", ways(0), ways(0.5), Met::shoulder, 2e-3, 1);
}

// Out beyond the full stretch and back, the elbow on either side of straight. Joints 2 and 3 stop
// and turn round together, each thrown by the other's torque.
TEST(Singularity, TheStretchedElbowIsPassedAtFullSpeed) {
  const auto ways = [](double bent) {
    std::vector<Way> out;
    for (const double side : {1.0, -1.0}) {
      if (side < 0 && bent > 30) continue;  // beyond the limit of joint 3
      const Vec6 q = joints_from_degrees({90, 60, 90 - side * bent, 10, 40, 20});
      const ArmKinematics at = kinematics(ArmGeometry{}, q);
      const Vec3 out_S = (at.p_S_wrist - Vec3(0, 0, ArmGeometry{}.d1)).normalized();
      for (const int times : {2, 4})
        out.push_back({q,
                       {.by_S = 0.06 * out_S, .lasting = 0.1, .times = times},
                       Vec3::Zero(),
                       Vec3::Zero()});
    }
    return out;
  };
  expect_passed("elbow", ways(1e-3), ways(70), Met::elbow, 0.3, 1.12);
}

}  // namespace
}  // namespace farhand
