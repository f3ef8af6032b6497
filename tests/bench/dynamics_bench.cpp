// The simulated arm, free and in contact: ours, semi-implicit Euler on our accelerations, and
// MuJoCo's integrators, at several step sizes, against a step of 1e-5 s and against the energy.
#include <map>

#include "slave/sim_arm.hpp"
#include "tests/bench/bench_table.hpp"
#include "tests/support/mujoco_arm.hpp"

namespace farhand::bench {
namespace {

constexpr double kReferenceStep = 1e-5;
constexpr double kSteps[] = {2e-3, 1e-3, 5e-4, 2e-4, 1e-4};
constexpr double kLookEvery = 0.01;  // [s], a multiple of every step

// A frictionless wall that the tip meets after 2 mm: pushed by 5 N, the arm bounces off it.
struct Scenario {
  std::string name = "free fall, 1 s";
  double duration = 1;
  double stiffness = 0;  // [N/m]; 0: no wall
  double wall_y = 0;     // [m], material beyond
  Vec6 tau = Vec6::Zero();
};

std::vector<Scenario> scenarios() {
  std::vector<Scenario> out(1);
  const ArmDynamics arm = make_arm_dynamics({});
  const ArmFrames home = arm_frames(arm, joint_trig(kTeleopHome));
  for (const double stiffness : {1e3, 1e4, 1e5, 1e6}) {
    char name[40];
    std::snprintf(name, sizeof name, "wall of %.0e N/m, 0.5 s", stiffness);
    const Wrench push{Vec3(0, 5, 0), Vec3::Zero()};
    out.push_back({name, 0.5, stiffness, home.X_SE.p.y() + 0.002,
                   gravity_torques(arm, kTeleopHome) + joint_torques(home, push)});
  }
  return out;
}

struct State {
  Vec6 q, dq;
};

// The product, asked for one step at a time.
class Ours {
 public:
  static constexpr const char* kName = kOurs;
  Ours(const Scenario& s, double h) : arm_(config(s, h)), h_(from_seconds(h)), tau_(s.tau) {
    arm_.write(now_, tau_);
  }
  void step() { arm_.write(now_ += h_, tau_); }
  State state() const {
    const SimArmTruth t = arm_.truth();
    return {t.q, t.dq};
  }

 private:
  static SimArmConfig config(const Scenario& s, double h) {
    SimArmConfig c{.rate_hz = 1 / h, .friction = false, .q = kTeleopHome};
    if (s.stiffness > 0) {
      c.surfaces.count = 1;
      c.surfaces.items[0] = {.shape = Plane{Vec3(0, s.wall_y, 0), Vec3(0, -1, 0)},
                             .stiffness = s.stiffness};
    }
    return c;
  }
  SimArm arm_;
  TimePoint now_{};
  Duration h_;
  Vec6 tau_;
};

class SemiImplicitEuler {
 public:
  static constexpr const char* kName = "semi-implicit Euler";
  SemiImplicitEuler(const Scenario& s, double h) : s_(s), h_(h) {}
  void step() {
    const JointTrig trig = joint_trig(x_.q);
    Vec6 tau = s_.tau;
    if (s_.stiffness > 0) {
      const ArmFrames frames = arm_frames(arm_, trig);
      const double depth = frames.X_SE.p.y() - s_.wall_y;
      if (depth > 0)
        tau += joint_torques(frames, {Vec3(0, -s_.stiffness * depth, 0), Vec3::Zero()});
    }
    x_.dq += h_ * forward_dynamics(arm_, trig, x_.dq, tau);
    x_.q += h_ * x_.dq;
  }
  State state() const { return x_; }

 private:
  ArmDynamics arm_ = make_arm_dynamics({});
  Scenario s_;
  double h_;
  State x_{kTeleopHome, Vec6::Zero()};
};

// The same wall as a passive force, so that every integrator sees the same equations.
Scenario mujoco_wall;
void push_back(const mjModel* m, mjData* d) {
  const double depth = d->site_xpos[1] - mujoco_wall.wall_y;
  if (!(mujoco_wall.stiffness > 0 && depth > 0)) return;
  Eigen::Matrix<double, 3, 6, Eigen::RowMajor> J;
  mj_jacSite(m, d, J.data(), nullptr, 0);
  Vec6::Map(d->qfrc_passive) -= mujoco_wall.stiffness * depth * J.row(1).transpose();
}

template <int kIntegrator>
class Mujoco {
 public:
  static constexpr const char* kName = kIntegrator == mjINT_EULER ? "MuJoCo Euler"
                                       : kIntegrator == mjINT_RK4 ? "MuJoCo RK4"
                                                                  : "MuJoCo implicit";
  Mujoco(const Scenario& s, double h) {
    mujoco_wall = s;
    mjcb_passive = push_back;
    arm().model->opt.integrator = kIntegrator;
    arm().model->opt.timestep = h;
    mj_resetData(arm().model.get(), arm().data.get());
    Vec6::Map(arm().data->qpos) = kTeleopHome;
    Vec6::Map(arm().data->qfrc_applied) = s.tau;
  }
  void step() { mj_step(arm().model.get(), arm().data.get()); }
  State state() const { return {Vec6::Map(arm().data->qpos), Vec6::Map(arm().data->qvel)}; }

 private:
  static MujocoArm& arm() {
    static MujocoArm arm{ArmModel{}};
    return arm;
  }
};

template <typename Integrator>
std::vector<State> simulate(const Scenario& s, double h) {
  Integrator arm(s, h);
  std::vector<State> seen;
  const auto steps = std::lround(s.duration / h), look = std::lround(kLookEvery / h);
  for (long i = 1; i <= steps; ++i) {
    arm.step();
    if (i % look == 0) seen.push_back(arm.state());
  }
  return seen;
}

// Kinetic, potential, of the wall, and less what the constant torques put in: stays as it was.
double energy_of(const Scenario& s, const ArmDynamics& arm, const State& x) {
  const double depth = arm_frames(arm, joint_trig(x.q)).X_SE.p.y() - s.wall_y;
  const double wall = s.stiffness > 0 && depth > 0 ? s.stiffness * depth * depth / 2 : 0;
  return energy(arm, x.q, x.dq) + wall - s.tau.dot(x.q);
}

Accuracy worst(double error, const char* unit, std::size_t looks, const std::string& note = {}) {
  if (std::isnan(error)) error = std::numeric_limits<double>::infinity();
  return {.usual = error, .worst = error, .unit = unit, .inputs = looks, .note = note};
}

double largest_difference(const std::vector<State>& a, const std::vector<State>& b) {
  double out = 0;
  for (std::size_t i = 0; i < a.size(); ++i) {
    const double d = (a[i].q - b[i].q).cwiseAbs().maxCoeff();
    out = d <= out ? out : d;  // NaN stays
  }
  return out;
}

template <typename Integrator>
void contend(Table& table, const Scenario& s, const std::vector<State>& reference) {
  const ArmDynamics arm = make_arm_dynamics({});
  const double start = energy_of(s, arm, {kTeleopHome, Vec6::Zero()});
  for (const double h : kSteps) {
    const std::vector<State> seen = simulate<Integrator>(s, h);
    double drift = 0;
    for (const State& x : seen) {
      const double d = std::abs(energy_of(s, arm, x) - start);
      drift = d <= drift ? drift : d;
    }
    char step[20];
    std::snprintf(step, sizeof step, "%.0e s", h);
    const Row path{{"arm dynamics, path", Integrator::kName, s.name, step},
                   worst(largest_difference(seen, reference), "rad", seen.size())};
    const Row energy{{"arm dynamics, energy", Integrator::kName, s.name, step},
                     worst(drift, "J", seen.size())};
    table.time(
        {path, energy}, 1,
        [=](std::size_t) {
          Integrator timed(s, h);
          const auto steps = std::lround(s.duration / h);
          for (long i = 0; i < steps; ++i) timed.step();
          return timed.state();
        },
        s.duration, "simulated second");
  }
}

void all_integrators(Table& table, const Scenario& s) {
  const std::vector<State> reference = simulate<Ours>(s, kReferenceStep);
  const auto mujoco = simulate<Mujoco<mjINT_RK4>>(s, kReferenceStep);
  std::fprintf(stderr, "%s: at 1e-5 s MuJoCo's RK4 and ours differ by %.2e rad\n", s.name.c_str(),
               largest_difference(reference, mujoco));
  contend<Ours>(table, s, reference);
  contend<SemiImplicitEuler>(table, s, reference);
  contend<Mujoco<mjINT_EULER>>(table, s, reference);
  contend<Mujoco<mjINT_RK4>>(table, s, reference);
  contend<Mujoco<mjINT_IMPLICIT>>(table, s, reference);
}

// A step as a scene's robot takes it, under torques that hold it up and shake it.
void one_step(Table& table, bool friction) {
  const Vec6 hold = gravity_torques(make_arm_dynamics({}), kTeleopHome);
  std::vector<Vec6> tau(1024);
  for (std::size_t i = 0; i < tau.size(); ++i)
    for (int j = 0; j < 6; ++j) tau[i][j] = hold[j] + std::sin(0.006 * double(i) * (j + 1));
  struct Running {
    SimArm arm;
    TimePoint now{};
  };
  auto sim = std::make_shared<Running>(
      Running{SimArm({.friction = friction, .q = kTeleopHome}), TimePoint{}});
  table.time({{{"arm step of 1 ms", kOurs, friction ? "gear friction" : "no friction"},
               {},
               friction ? 2000 : kNone}},
             tau.size(), [=](std::size_t i) {
               if (i == 0) *sim = {SimArm({.friction = friction, .q = kTeleopHome}), TimePoint{}};
               sim->arm.write(sim->now += std::chrono::milliseconds(1), tau[i]);
               return sim->arm.status().steps;
             });
}

}  // namespace
}  // namespace farhand::bench

int main(int argc, char** argv) {
  using namespace farhand::bench;
  Table table(argc, argv);
  for (const Scenario& s : scenarios()) all_integrators(table, s);
  one_step(table, true);
  one_step(table, false);
  return table.finish();
}
