// Falcon and twin delta, forward and inverse: the product against textbook formulas and Newton's
// method at several tolerances, in double and float.
#include <random>

#include "tests/bench/bench_table.hpp"
#include "tests/bench/quad.hpp"

namespace farhand::bench {
namespace {

constexpr FalconGeometry kFalcon = kFalconTable1;
constexpr unsigned kSeed = 4711;
constexpr std::size_t kTimed = 4096;  // inputs that are timed; errors are of all

struct Draw {
  std::mt19937_64 generator{kSeed};
  double operator()(double low, double high) {
    return std::uniform_real_distribution<double>(low, high)(generator);
  }
  Vec3 in_ball(double radius) {
    for (;;) {
      const Vec3 v(operator()(-1, 1), operator()(-1, 1), operator()(-1, 1));
      if (v.norm() <= 1) return radius * v;
    }
  }
};

struct FalconInput {
  Vec3 p, previous, theta;
};
struct TwinInput {
  TwinDeltaPose pose, previous;
  Vec6 theta;
};

// The handle in its workspace, and half a millimetre away one sample before.
std::vector<FalconInput> falcon_inputs(std::size_t n) {
  Draw draw;
  std::vector<FalconInput> out(n);
  for (FalconInput& i : out) {
    i.p = Vec3(0, 0, 0.12) + draw.in_ball(0.055);
    i.previous = i.p + draw.in_ball(0.0005);
    i.theta = motor_angles(kFalcon, i.p).theta1;
  }
  return out;
}
std::vector<TwinInput> twin_inputs(std::size_t n) {
  Draw draw;
  std::vector<TwinInput> out(n);
  for (TwinInput& i : out) {
    do {
      i.pose = {Vec3(0.18, 0, 0) + draw.in_ball(0.05),
                Vec3(draw(-0.5, 0.5), draw(-0.5, 0.5), 1).normalized(), draw(0.14, 0.20)};
      i.previous = i.pose;
      i.previous.p_MH += draw.in_ball(0.0005);
      const TwinDeltaMotorAngles found = motor_angles(kTwinDelta, i.pose);
      i.theta = found.status == Status::ok ? found.theta1 : Vec6::Zero();
    } while (i.theta.isZero());
  }
  return out;
}

// From the middle outwards to where the first leg is stretched to 1e-8 of the way.
std::vector<FalconInput> falcon_edge(std::size_t n) {
  std::vector<FalconInput> out = falcon_inputs(n);
  for (FalconInput& i : out) {
    const Vec3 middle(0, 0, 0.12), direction = (i.p - middle).normalized();
    double inside = 0.04, outside = 0.4;
    while (outside - inside > 1e-10) {
      const double x = (inside + outside) / 2;
      (motor_angles(kFalcon, middle + x * direction).status == Status::ok ? inside : outside) = x;
    }
    i.p = middle + inside * (1 - 1e-8) * direction;
    i.theta = motor_angles(kFalcon, i.p).theta1;
  }
  return out;
}

template <typename Input, typename F>
Accuracy judge(const std::vector<Input>& inputs, const char* unit, F&& error) {
  std::vector<double> errors;
  for (const Input& i : inputs) errors.push_back(error(i));
  return accuracy(std::move(errors), unit);
}

// One contender: `solve` answers, `error` judges the answer.
template <typename Input, typename Solve, typename Error>
void contend(Table& table, Label label, const std::vector<Input>& inputs, const char* unit,
             Solve solve, Error error, double target_ns = kNone) {
  const Accuracy a = judge(inputs, unit, [&](const Input& i) { return error(i, solve(i)); });
  std::vector<Input> timed(inputs.begin(),
                           inputs.begin() + static_cast<long>(std::min(kTimed, inputs.size())));
  const std::size_t n = timed.size();
  table.time({{label, a, target_ns}}, n,
             [timed = std::move(timed), solve](std::size_t i) { return solve(timed[i]); });
}

template <typename T>
Vec3 to_vec3(const Point<T>& p) {
  return {double(p[0]), double(p[1]), double(p[2])};
}
constexpr double kTolerances[] = {1e-3, 1e-5, 1e-7, 1e-9, 1e-12};
std::string text(double tolerance) {
  char out[32];
  std::snprintf(out, sizeof out, "%.0e m", tolerance);
  return out;
}

void falcon_inverse(Table& table, const char* set, const std::vector<FalconInput>& inputs) {
  const auto error = [](const FalconInput& i, const auto& theta) {
    return falcon_angle_error(kFalcon, i.p, theta.template cast<double>(), i.theta);
  };
  const auto add = [&](const char* contender, const char* what, auto solve, double target = kNone) {
    contend(table, {"Falcon inverse", contender, set, what}, inputs, "rad", solve, error, target);
  };
  add(
      kOurs, "motor angles", [](const FalconInput& i) { return motor_angles(kFalcon, i.p).theta1; },
      std::string_view(set) == "workspace" ? 95 : kNone);
  add("Farhand, all angles", "", [](const FalconInput& i) { return inverse(kFalcon, i.p).theta1; });
  add("law of cosines", "double",
      [](const FalconInput& i) { return falcon_angles<double>(kFalcon, i.p); });
  add("law of cosines", "float",
      [](const FalconInput& i) { return falcon_angles<float>(kFalcon, i.p); });
}

template <typename T>
void falcon_newtons(Table& table, const std::vector<FalconInput>& inputs, const char* contender) {
  const auto error = [](const FalconInput& i, const Point<T>& p) {
    return falcon_position_error(kFalcon, i.theta, to_vec3<T>(p), i.p);
  };
  for (const double tolerance : kTolerances) {
    if (std::is_same_v<T, float> && tolerance < 1e-7) break;
    contend(
        table, {"Falcon forward", contender, "warm, 0.5 mm away", text(tolerance)}, inputs, "m",
        [=](const FalconInput& i) {
          return falcon_newton<T>(kFalcon, i.theta, point<T>(i.previous), T(tolerance));
        },
        error);
    contend(
        table, {"Falcon forward", contender, "cold, from the middle", text(tolerance)}, inputs, "m",
        [=](const FalconInput& i) {
          return falcon_newton<T>(kFalcon, i.theta, {T(0), T(0), T(0.12)}, T(tolerance));
        },
        error);
  }
}

void falcon_forward(Table& table, const std::vector<FalconInput>& inputs) {
  const auto error = [](const FalconInput& i, const Vec3& p) {
    return falcon_position_error(kFalcon, i.theta, p, i.p);
  };
  contend(
      table, {"Falcon forward", kOurs, "warm, 0.5 mm away"}, inputs, "m",
      [](const FalconInput& i) { return forward(kFalcon, i.theta, i.previous).p_MH; }, error, 140);
  contend(
      table, {"Falcon forward", kOurs, "cold, from the middle"}, inputs, "m",
      [](const FalconInput& i) { return forward(kFalcon, i.theta).p_MH; }, error, 330);
  falcon_newtons<double>(table, inputs, "Newton, double");
  falcon_newtons<float>(table, inputs, "Newton, float");
}

void twin_delta_inverse(Table& table, const std::vector<TwinInput>& inputs) {
  const auto error = [](const TwinInput& i, const auto& theta) {
    return twin_delta_angle_error(kTwinDelta, i.pose, theta.template cast<double>(), i.theta);
  };
  const auto add = [&](const char* contender, const char* what, auto solve, double target = kNone) {
    contend(table, {"twin delta inverse", contender, "workspace", what}, inputs, "rad", solve,
            error, target);
  };
  add(
      kOurs, "motor angles",
      [](const TwinInput& i) { return motor_angles(kTwinDelta, i.pose).theta1; }, 160);
  add("Farhand, all angles", "",
      [](const TwinInput& i) { return inverse(kTwinDelta, i.pose).theta1; });
  add("law of cosines", "double",
      [](const TwinInput& i) { return twin_delta_angles<double>(kTwinDelta, i.pose); });
  add("law of cosines", "float",
      [](const TwinInput& i) { return twin_delta_angles<float>(kTwinDelta, i.pose); });
}

// The pose that two ends, each in its half's axes, make.
template <typename T>
TwinDeltaPose grip(const Point<T>& upper, const Point<T>& lower) {
  using V = Eigen::Matrix<T, 3, 1>;
  const T a = T(kTwinDelta.a12);
  const V E1(upper[0], upper[1], upper[2] + a), E2(lower[0], -lower[1], -(lower[2] + a));
  const V span = E1 - E2, middle = (E1 + E2) / 2;
  const T length = span.norm();
  return {middle.template cast<double>(), (span / length).template cast<double>(), double(length)};
}

template <typename T>
void twin_delta_plain(Table& table, const std::vector<TwinInput>& inputs, const char* precision) {
  const auto error = [](const TwinInput& i, const TwinDeltaPose& pose) {
    return twin_delta_position_error(kTwinDelta, i.theta, pose, i.pose);
  };
  contend(
      table, {"twin delta forward", "plain spheres", "workspace", precision}, inputs, "m",
      [](const TwinInput& i) {
        return grip<T>(twin_delta_spheres<T>(kTwinDelta, i.theta, 0),
                       twin_delta_spheres<T>(kTwinDelta, i.theta, 1));
      },
      error);
  for (const double tolerance : kTolerances) {
    if (std::is_same_v<T, float> && tolerance < 1e-7) break;
    contend(
        table,
        {"twin delta forward", std::string("Newton, ") + precision, "workspace", text(tolerance)},
        inputs, "m",
        [=](const TwinInput& i) {
          const auto start = ends_in_halves<T>(kTwinDelta, i.previous);
          const T t = T(tolerance);
          return grip<T>(twin_delta_newton<T>(kTwinDelta, i.theta, 0, start[0], t),
                         twin_delta_newton<T>(kTwinDelta, i.theta, 1, start[1], t));
        },
        error);
  }
}

void twin_delta_forward(Table& table, const std::vector<TwinInput>& inputs) {
  contend(
      table, {"twin delta forward", kOurs, "workspace"}, inputs, "m",
      [](const TwinInput& i) {
        TwinDeltaForward out;
        solve_forward(kTwinDelta, i.theta, out);
        return out.pose;
      },
      [](const TwinInput& i, const TwinDeltaPose& pose) {
        return twin_delta_position_error(kTwinDelta, i.theta, pose, i.pose);
      },
      130);
  twin_delta_plain<double>(table, inputs, "double");
  twin_delta_plain<float>(table, inputs, "float");
}

}  // namespace
}  // namespace farhand::bench

int main(int argc, char** argv) {
  using namespace farhand::bench;
  Table table(argc, argv);
  const auto falcon = falcon_inputs(table.inputs(20000));
  falcon_inverse(table, "workspace", falcon);
  falcon_inverse(table, "a leg stretched to 1e-8", falcon_edge(table.inputs(5000)));
  falcon_forward(table, falcon);
  const auto twin = twin_inputs(table.inputs(20000));
  twin_delta_inverse(table, twin);
  twin_delta_forward(table, twin);
  return table.finish();
}
