// Both ticks, whole scenes, through everything that must not happen: the handle thrown about at
// 2 m/s, the robot commanded through its singularities, and faults in one tick of a hundred:
// samples that are repeated, forces that are not finite, huge or denormal, messages that are lost
// or senseless, clocks that step; and every other four seconds what ends an engagement, too: the
// handle beyond its workspace and through its singularities, readings that are missing or
// senseless. After each tick: finite, within
// limits and slew, state legal. FARHAND_STRESS_TICKS sets how many (deploy/stress.sh runs 10^8).
#include <gtest/gtest.h>

#include <cmath>
#include <cstdio>

#include "common/codec.hpp"
#include "common/random.hpp"
#include "common/scene.hpp"
#include "master/build.hpp"
#include "slave/build.hpp"
#include "tests/support/scene_edits.hpp"
#include "tests/support/senseless.hpp"
#include "tests/support/stress.hpp"

namespace farhand {
namespace {

constexpr double kRoom = 1e-9;  // relative, for the limiters' own arithmetic

bool rare(Random& random) {
  return random.uniform() < 0.01;
}

// A point thrown about between random places of a box, and the twin delta's or Falcon's motor
// angles for it; out of reach they go on at random.
class ThrownHandle {
 public:
  ThrownHandle(const MasterConfig& config, double Ts) : handle_(config.handle), step_(2 * Ts) {}

  const Vec6& next(Random& random, bool far) {
    const Vec3 way = to_ - p_;
    if (way.norm() < step_) to_ = place(random, far ? 0.2 : 0.07);
    p_ += clamp_norm(way, step_);
    if (!far) axis_ = Vec3(0.2, 0.1, 1).normalized();
    axis_ = (axis_ + 0.02 * Vec3(random.normal(), random.normal(), random.normal())).normalized();
    if (!std::visit([&](const auto& h) { return reach(h); }, handle_))
      for (double& t : theta_) t += 0.01 * random.normal();
    return theta_;
  }

 private:
  Vec3 place(Random& random, double box) const {
    const Vec3 middle =
        std::holds_alternative<FalconHandle>(handle_) ? Vec3(0, 0, 0.12) : Vec3(0.18, 0, 0);
    return middle +
           box * Vec3(random.uniform() - 0.5, random.uniform() - 0.5, random.uniform() - 0.5);
  }
  bool reach(const FalconHandle& h) {
    const auto at = motor_angles(h.geometry, p_);
    if (at.status == Status::ok) theta_.head<3>() = at.theta1;
    return at.status == Status::ok;
  }
  bool reach(const TwinDeltaHandle& h) {
    const auto at = motor_angles(h.geometry, {.p_MH = p_, .axis = axis_, .length = 0.17});
    if (at.status == Status::ok) theta_ = at.theta1;
    return at.status == Status::ok;
  }

  Handle handle_;
  double step_;
  Vec3 p_ = Vec3(0.15, 0, 0.1), to_ = p_, axis_ = Vec3::UnitZ();
  Vec6 theta_ = Vec6::Zero();
};

class Bench {
 public:
  Bench(const Scene& scene, std::uint64_t seed)
      : random_(seed),
        m_(master_config(scene.proto)),
        s_(slave_config(scene.proto)),
        master_(m_),
        slave_(s_),
        thrown_(m_, m_.Ts) {
    for (int i = 0; i < 6; ++i) tau_max_[i] = s_.model.links[i].torque_limit;
    robot_.ok = true;
    robot_.q = kTeleopHome;
  }

  void tick() {
    storm_ = ++ticks_ / 4000 % 2 == 1;
    now_ += from_seconds(m_.Ts);
    if (rare(random_)) now_ += from_seconds(random_.uniform() < 0.5 ? -m_.Ts : 0.3);
    hear();
    check_message(master_.sample(now_, reading(), {newest_up(), connected_, age_up_, true}));
    check(master_.actuate(now_, {newest_up(), connected_, age_up_, true}));
    const SlaveTick& s = slave_.tick(now_, {newest_down(), connected_, age_down_, true}, robot());
    check(s);
    follow(s);
  }
  std::uint64_t engaged() const { return engaged_; }
  std::uint64_t coupled() const { return coupled_; }

 private:
  const SlaveToMaster* newest_up() const { return has_up_ ? &up_ : nullptr; }
  const MasterToSlave* newest_down() const { return has_down_ ? &down_ : nullptr; }

  // Messages arrive, or age, or are senseless as far as the codec lets them be.
  void hear() {
    connected_ = !(lost_ > 0 ? --lost_ > 0 : random_.uniform() < 5e-5 && (lost_ = 600) > 0);
    const Duration Ts = from_seconds(m_.Ts);
    const bool arrive = connected_ && !rare(random_);
    age_up_ = age_down_ = arrive ? Duration(0) : age_up_ + Ts;
    if (!arrive) return;
    SlaveToMaster up = slave_out_;
    MasterToSlave down = master_out_;
    if (rare(random_)) spoil(random_, up.F_E_M.force);
    if (rare(random_)) spoil(random_, down.p_MH);
    if (rare(random_))
      down.q_MH = Quat(random_.normal(), random_.normal(), random_.normal(), 1).normalized();
    if (valid(up)) up_ = up, has_up_ = true;
    if (valid(down)) down_ = down, has_down_ = true;
  }

  HandleReading reading() {
    HandleReading r{.ok = !harsh(), .has_force = !rare(random_)};
    const Vec6& theta = thrown_.next(random_, storm_);
    r.theta = rare(random_) ? last_.theta : theta;
    if (harsh()) spoil(random_, r.theta);
    // The dead-man is held for a second or two at a time.
    if (random_.uniform() < 0.0007) held_ = !held_;
    r.dead_man = held_;
    r.clutch = random_.uniform() < 0.02;
    for (Vec3* f : {&r.ends.f_E1_M, &r.ends.f_E2_A2}) {
      *f = 5 * Vec3(random_.normal(), random_.normal(), random_.normal());
      if (rare(random_)) spoil(random_, *f);
    }
    return last_ = r;
  }

  RobotReading robot() {
    RobotReading r = robot_;
    r.ok = !harsh();
    r.F_E_S = {30 * Vec3(random_.normal(), random_.normal(), random_.normal()), Vec3::Zero()};
    if (harsh()) spoil(random_, r.q);
    if (harsh()) spoil(random_, r.dq);
    if (rare(random_)) spoil(random_, r.F_E_S.force);
    if (rare(random_)) spoil(random_, r.F_E_S.torque);
    return r;
  }

  void check_message(const MasterToSlave& out) {
    master_out_ = out;
    ASSERT_TRUE(valid(out)) << "a message of the master that cannot be sent";
  }

  void check(const MasterTick& t) {
    const double most = m_.max_motor_torque, step = most * m_.Ts / m_.torque_rise_time_s;
    ASSERT_TRUE(t.tau.allFinite() && is_finite(t.F_G) && is_finite(t.F_env_G));
    ASSERT_LE(t.tau.cwiseAbs().maxCoeff(), most * (1 + kRoom));
    ASSERT_TRUE(t.tau.isZero() || (t.tau - tau_).cwiseAbs().maxCoeff() <= step * (1 + kRoom));
    ASSERT_TRUE(is_legal(master_mode_, t.mode));
    if (m_.force_feedback) {
      const WrenchLimits& limits = m_.force_feedback->controller.limits;
      ASSERT_LE(t.F_G.force.norm(), limits.force * (1 + kRoom));
      ASSERT_LE(t.F_G.torque.norm(), limits.torque * (1 + kRoom));
      ASSERT_LE((t.F_G.force - F_G_.force).norm(), limits.force_step * (1 + kRoom));
    }
    engaged_ += t.mode == Mode::engaged;
    // Where no force is accepted none was given.
    F_G_ = (t.limits & kLimitAcceptance) != 0 ? Wrench{} : t.F_G;
    tau_ = t.tau, master_mode_ = t.mode;
  }

  void check(const SlaveTick& t) {
    ASSERT_TRUE(t.tau.allFinite() && t.q_cmd.allFinite());
    ASSERT_LE(t.tau.cwiseAbs().cwiseQuotient(tau_max_).maxCoeff(), 1 + kRoom);
    ASSERT_TRUE(is_legal(slave_mode_, t.mode));
    if (started_) {
      const Vec6 slew = tau_max_ * (s_.Ts / s_.torque_rise_time_s);
      ASSERT_LE((t.tau - joint_tau_).cwiseAbs().cwiseQuotient(slew).maxCoeff(), 1 + kRoom);
      const Vec6 step = s_.joints.speed * s_.Ts;
      const double moved = (t.q_cmd - q_cmd_).cwiseAbs().cwiseQuotient(step).maxCoeff();
      ASSERT_TRUE(moved <= 1 + kRoom || t.q_cmd == t.robot.q);  // or found there, by two readings
      ASSERT_TRUE(((t.q_cmd - s_.joints.lower).array() >= -kRoom).all() &&
                  ((s_.joints.upper - t.q_cmd).array() >= -kRoom).all());
    }
    coupled_ += t.coupled;
    started_ = true;
    joint_tau_ = t.tau, q_cmd_ = t.q_cmd, slave_mode_ = t.mode;
    slave_out_ = t.out;
    ASSERT_TRUE(valid(t.out)) << "a message of the slave that cannot be sent";
  }

  // A robot that goes where it is told, without inertia.
  void follow(const SlaveTick& t) {
    robot_.dq = (t.q_cmd - robot_.q) / s_.Ts;
    robot_.q = t.q_cmd;
  }

  // A fault that ends an engagement.
  bool harsh() { return storm_ && rare(random_); }

  Random random_;
  std::uint64_t ticks_ = 0;
  bool storm_ = false;
  MasterConfig m_;
  SlaveConfig s_;
  Master master_;
  Slave slave_;
  ThrownHandle thrown_;
  TimePoint now_{std::chrono::hours(1)};

  HandleReading last_;
  bool held_ = false;
  RobotReading robot_;
  SlaveToMaster slave_out_, up_;
  MasterToSlave master_out_, down_;
  bool has_up_ = false, has_down_ = false, connected_ = true;
  int lost_ = 0;
  Duration age_up_{}, age_down_{};

  Vec6 tau_ = Vec6::Zero(), joint_tau_ = Vec6::Zero(), q_cmd_ = Vec6::Zero(), tau_max_;
  Wrench F_G_;
  Mode master_mode_ = Mode::disconnected, slave_mode_ = Mode::disconnected;
  bool started_ = false;
  std::uint64_t engaged_ = 0, coupled_ = 0;
};

class StressedTicks : public testing::TestWithParam<const char*> {};

TEST_P(StressedTicks, StayFiniteWithinLimitsAndLegal) {
  const Scene scene = shipped(GetParam());
  constexpr std::uint64_t kSeed = 5;
  const std::uint64_t ticks = stress_ticks(100'000);
  Bench bench(scene, kSeed);
  for (std::uint64_t k = 0; k < ticks; ++k) {
    bench.tick();
    ASSERT_FALSE(HasFatalFailure()) << GetParam() << ", seed " << kSeed << ", tick " << k;
  }
  const auto percent = [&](std::uint64_t n) {
    return 100 * static_cast<double>(n) / static_cast<double>(ticks);
  };
  std::printf("%s: %llu ticks, engaged in %.0f %%, coupled in %.0f %%\n", GetParam(),
              static_cast<unsigned long long>(ticks), percent(bench.engaged()),
              percent(bench.coupled()));
  EXPECT_GT(bench.coupled(), ticks / 20);  // else the faults hid the control
}

INSTANTIATE_TEST_SUITE_P(Scenes, StressedTicks,
                         testing::Values("full", "twin_delta_closed", "falcon_arm"),
                         [](const auto& scene) { return std::string(scene.param); });

}  // namespace
}  // namespace farhand
