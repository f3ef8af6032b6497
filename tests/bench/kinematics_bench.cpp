// The arm's pose, Jacobian and inverse: ours, KDL, MuJoCo, and damped least squares.
#include <Eigen/Cholesky>
#include <kdl/chainfksolverpos_recursive.hpp>
#include <kdl/chainiksolverpos_lma.hpp>
#include <kdl/chainiksolverpos_nr_jl.hpp>
#include <kdl/chainiksolvervel_pinv.hpp>
#include <kdl/chainjnttojacsolver.hpp>

#include "tests/bench/arm_sets.hpp"
#include "tests/bench/bench_table.hpp"
#include "tests/support/kdl_arm.hpp"
#include "tests/support/mujoco_arm.hpp"

namespace farhand::bench {
namespace {

const ArmGeometry kArm;
const JointLimits kLimits;
constexpr std::size_t kTimed = 4096;  // inputs that are timed; errors are of all
constexpr double kAnswered = 1e-3;    // a residual above it is no answer

KDL::JntArray to_kdl(const Vec6& q) {
  KDL::JntArray out(6);
  out.data = q;
  return out;
}
KDL::Frame to_kdl(const Pose& X) {
  KDL::Frame out;
  for (int i = 0; i < 3; ++i) {
    out.p(i) = X.p[i];
    for (int j = 0; j < 3; ++j) out.M(i, j) = X.R(i, j);
  }
  return out;
}
Pose from_kdl(const KDL::Frame& X) {
  Pose out;
  for (int i = 0; i < 3; ++i) {
    out.p[i] = X.p(i);
    for (int j = 0; j < 3; ++j) out.R(i, j) = X.M(i, j);
  }
  return out;
}

struct PoseAndJacobian {
  Pose X_SE;
  ArmJacobian J;
};

struct KdlForward {
  KDL::Chain chain = kdl_chain(kArm);
  KDL::ChainFkSolverPos_recursive pose{chain};
  KDL::ChainJntToJacSolver jacobian{chain};
  KDL::Frame X;
  KDL::Jacobian J{6};
};

struct MujocoForward : MujocoArm {
  MujocoForward() : MujocoArm(ArmModel{}) {}
  void kinematics(const Vec6& q) {
    Vec6::Map(data->qpos) = q;
    mj_kinematics(model.get(), data.get());
  }
  void jacobian() {
    mj_comPos(model.get(), data.get());
    mj_jacSite(model.get(), data.get(), J.data(), J.data() + 18, 0);
  }
  Pose pose() const {
    return {Eigen::Map<Eigen::Matrix<double, 3, 3, Eigen::RowMajor>>(data->site_xmat),
            Vec3::Map(data->site_xpos)};
  }
  Eigen::Matrix<double, 6, 6, Eigen::RowMajor> J;
};

// One contender. `work(i)` is timed, `result(i)` the same with the answer in our types.
template <typename Work, typename Result>
void contend_forward(Table& table, const char* subject, const char* contender,
                     const std::vector<QuadArm>& exact, std::size_t timed, double target, Work work,
                     Result result) {
  std::vector<double> errors;
  for (std::size_t i = 0; i < exact.size(); ++i) errors.push_back(result(i, exact[i]));
  table.time({{{subject, contender, "uniform"}, accuracy(errors, "m or 1"), target}}, timed, work);
}

void forward_kinematics(Table& table) {
  Draw draw;
  std::vector<Vec6> q(table.inputs(100000));
  std::vector<KDL::JntArray> q_kdl;
  std::vector<QuadArm> exact;
  for (Vec6& x : q) {
    x = draw.joints(kLimits);
    q_kdl.push_back(to_kdl(x));
    exact.push_back(quad_arm(kArm, x));
  }
  const std::size_t n = std::min(kTimed, q.size());
  auto kdl = std::make_shared<KdlForward>();
  auto mujoco = std::make_shared<MujocoForward>();
  const auto from_parts = [](const Pose& X, const auto& J) {
    return PoseAndJacobian{X, {J.template topRows<3>(), J.template bottomRows<3>()}};
  };
  const auto both = [](const QuadArm& exact_arm, const Pose& X, const ArmJacobian& J) {
    return std::max(pose_error(exact_arm, X), jacobian_error(exact_arm, J));
  };

  contend_forward(
      table, "arm pose", kOurs, exact, n, 60, [=](std::size_t i) { return forward(kArm, q[i]); },
      [&](std::size_t i, const QuadArm& e) { return pose_error(e, forward(kArm, q[i])); });
  const auto kdl_pose = [=](std::size_t i) {
    kdl->pose.JntToCart(q_kdl[i], kdl->X);
    return &kdl->X;
  };
  contend_forward(
      table, "arm pose", "KDL", exact, n, kNone, kdl_pose,
      [&](std::size_t i, const QuadArm& e) { return pose_error(e, from_kdl(*kdl_pose(i))); });
  const auto mujoco_pose = [=](std::size_t i) {
    mujoco->kinematics(q[i]);
    return mujoco->data->site_xpos;
  };
  contend_forward(table, "arm pose", "MuJoCo", exact, n, kNone, mujoco_pose,
                  [&](std::size_t i, const QuadArm& e) {
                    mujoco_pose(i);
                    return pose_error(e, mujoco->pose());
                  });

  contend_forward(
      table, "arm pose and Jacobian", kOurs, exact, n, 60,
      [=](std::size_t i) { return kinematics(kArm, q[i]); },
      [&](std::size_t i, const QuadArm& e) {
        const ArmKinematics k = kinematics(kArm, q[i]);
        return both(e, k.X_SE, k.J);
      });
  const auto kdl_both = [=](std::size_t i) {
    kdl->pose.JntToCart(q_kdl[i], kdl->X);
    kdl->jacobian.JntToJac(q_kdl[i], kdl->J);
    return kdl.get();
  };
  contend_forward(table, "arm pose and Jacobian", "KDL", exact, n, kNone, kdl_both,
                  [&](std::size_t i, const QuadArm& e) {
                    kdl_both(i);
                    const PoseAndJacobian r = from_parts(from_kdl(kdl->X), kdl->J.data);
                    return both(e, r.X_SE, r.J);
                  });
  const auto mujoco_both = [=](std::size_t i) {
    mujoco->kinematics(q[i]);
    mujoco->jacobian();
    return mujoco->J.data();
  };
  contend_forward(table, "arm pose and Jacobian", "MuJoCo", exact, n, kNone, mujoco_both,
                  [&](std::size_t i, const QuadArm& e) {
                    mujoco_both(i);
                    const PoseAndJacobian r = from_parts(mujoco->pose(), mujoco->J);
                    return both(e, r.X_SE, r.J);
                  });
}

// What an inverse answered: its joints, and whether it said that they reach the pose.
struct Answer {
  Vec6 q = Vec6::Zero();
  bool ok = false;
};

struct OurInverse {
  Answer operator()(const Pose& X_SE, const Vec6& start) const {
    const ArmNearest n = inverse(kArm, kLimits, X_SE, start);
    return {n.q, n.status == Status::ok};
  }
};

// Damped least squares, a given number of steps.
struct DampedLeastSquares {
  int steps;
  static constexpr double kDamping2 = 1e-8;
  Answer operator()(const Pose& X_SE, Vec6 q) const {
    Vec6 miss;
    for (int i = 0; i < steps; ++i) {
      const ArmKinematics k = kinematics(kArm, q);
      miss << X_SE.p - k.X_SE.p, rotation_vector(X_SE.R * k.X_SE.R.transpose());
      Mat6 J;
      J << k.J.linear, k.J.angular;
      const Mat6 damped = J * J.transpose() + kDamping2 * Mat6::Identity();
      q += J.transpose() * damped.ldlt().solve(miss);
    }
    return {q, miss.norm() < kAnswered};
  }
};

struct Lma {
  explicit Lma(double tolerance)
      : chain(kdl_chain(kArm)),
        solver(chain, Eigen::Matrix<double, 6, 1>::Ones(), tolerance, 500, 1e-15),
        out(6) {}
  KDL::Chain chain;
  KDL::ChainIkSolverPos_LMA solver;
  KDL::JntArray out;
};
struct NewtonRaphson {
  explicit NewtonRaphson(double tolerance)
      : chain(kdl_chain(kArm)),
        pose(chain),
        velocity(chain),
        solver(chain, to_kdl(kLimits.lower), to_kdl(kLimits.upper), pose, velocity, 100, tolerance),
        out(6) {}
  KDL::Chain chain;
  KDL::ChainFkSolverPos_recursive pose;
  KDL::ChainIkSolverVel_pinv velocity;
  KDL::ChainIkSolverPos_NR_JL solver;
  KDL::JntArray out;
};
// Given and answering in our types; converting costs a few nanoseconds of microseconds.
template <typename Solver>
struct KdlInverse {
  std::shared_ptr<Solver> kdl;
  Answer operator()(const Pose& X_SE, const Vec6& start) const {
    const int status = kdl->solver.CartToJnt(to_kdl(start), to_kdl(X_SE), kdl->out);
    return {kdl->out.data, status >= 0};
  }
};

// Feeds a set to an inverse: each input with a start of its own, or, along a trajectory, from the
// last answer.
template <typename Inverse>
struct Feed {
  std::shared_ptr<const ArmSet> set;
  Inverse solve;
  Vec6 last = Vec6::Zero();
  Answer operator()(std::size_t i) {
    const ArmTarget& t = set->targets[i];
    const Answer a = solve(t.X_SE, set->trajectory && i > 0 ? last : t.start);
    if (a.q.allFinite()) last = a.q;
    return a;
  }
};

constexpr double kLeap = 0.5;  // [rad] of a joint, from where the arm is

// Error: the residual of the pose; where there is nothing to reach, 1 if the answer claims to.
template <typename Inverse>
Accuracy judge(const std::shared_ptr<const ArmSet>& set, const Inverse& solve) {
  Feed<Inverse> feed{set, solve};
  std::vector<double> errors;
  std::size_t unanswered = 0;
  std::size_t leaps = 0;
  for (std::size_t i = 0; i < set->targets.size(); ++i) {
    const Vec6 before = set->trajectory && i > 0 ? feed.last : set->targets[i].start;
    const Answer a = feed(i);
    errors.push_back(set->reachable ? residual(kArm, a.q, set->targets[i].X_SE) : a.ok);
    if (!(errors.back() < kAnswered)) ++unanswered;
    if (a.ok && (a.q - before).cwiseAbs().maxCoeff() > kLeap) ++leaps;
  }
  const auto percent = [&](std::size_t n) { return 100 * double(n) / double(errors.size()); };
  char note[100];
  std::snprintf(note, sizeof note,
                set->reachable ? "%.3g %% unanswered, %.3g %% leaps" : "%.3g %% not refused",
                percent(unanswered), percent(leaps));
  return accuracy(std::move(errors), set->reachable ? "m or 1" : "accepted", note);
}

template <typename Inverse>
void contend_inverse(Table& table, const std::shared_ptr<const ArmSet>& set, const char* contender,
                     const std::string& parameter, const Inverse& solve, double target = kNone) {
  table.time({{{"arm inverse", contender, set->name, parameter}, judge(set, solve), target}},
             std::min(kTimed, set->targets.size()), Feed<Inverse>{set, solve});
}

void inverse_kinematics(Table& table, const std::shared_ptr<const ArmSet>& set) {
  contend_inverse(table, set, kOurs, "nearest", OurInverse{}, set->name == "uniform" ? 150 : kNone);
  for (const double tolerance : {1e-3, 1e-6, 1e-9, 1e-12}) {
    char text[20];
    std::snprintf(text, sizeof text, "%.0e", tolerance);
    contend_inverse(table, set, "KDL LMA", text, KdlInverse<Lma>{std::make_shared<Lma>(tolerance)});
    contend_inverse(table, set, "KDL NR_JL", text,
                    KdlInverse<NewtonRaphson>{std::make_shared<NewtonRaphson>(tolerance)});
  }
  for (const int steps : {1, 2, 4, 8, 16})
    contend_inverse(table, set, "damped least squares", std::to_string(steps) + " steps",
                    DampedLeastSquares{steps});
}

// Only ours answers with all eight; the error is that of the worst row.
void all_eight(Table& table, const std::shared_ptr<const ArmSet>& set) {
  std::vector<double> errors;
  for (const ArmTarget& t : set->targets) {
    double worst = 0;
    const ArmInverse all = inverse_all(kArm, t.X_SE, t.start);
    for (const Vec6& q : all.rows) worst = std::max(worst, residual(kArm, q, t.X_SE));
    errors.push_back(worst);
  }
  table.time({{{"arm inverse, all eight", kOurs, set->name}, accuracy(errors, "m or 1"), 200}},
             std::min(kTimed, set->targets.size()), [set](std::size_t i) {
               return inverse_all(kArm, set->targets[i].X_SE, set->targets[i].start);
             });
}

}  // namespace
}  // namespace farhand::bench

int main(int argc, char** argv) {
  using namespace farhand::bench;
  Table table(argc, argv);
  forward_kinematics(table);
  const auto sets = arm_sets(table.inputs(100000), table.inputs(5000));
  for (const auto& set : sets) inverse_kinematics(table, set);
  all_eight(table, sets.front());
  return table.finish();
}
