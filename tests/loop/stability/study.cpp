#include "tests/loop/stability/study.hpp"

#include <spdlog/fmt/fmt.h>

#include <cmath>

#include "tests/loop/stability/simulated.hpp"

namespace farhand {
namespace {

std::vector<Parameter> parameters_of(const AxisModel& m) {
  if (!m.reflects) return {Parameter::wall_stiffness};
  std::vector<Parameter> out{Parameter::wall_stiffness, Parameter::reflection_gain,
                             Parameter::round_trip};
  if (m.force) out.push_back(Parameter::loop_gain);
  return out;
}

// "... below 1234 N/m", or nothing where no value would do.
std::string remedy(const Scene& scene, int surface, Parameter p, const char* field) {
  const StabilityLimit limit = predicted_limit(scene, surface, p);
  if (limit.value == 0) return {};
  return fmt::format("{} below {}", field, quantity(p, limit.value));
}

std::string warning(const Scene& scene, int surface, const AxisModel& m) {
  const StabilityLimit wall = predicted_limit(scene, surface, Parameter::wall_stiffness);
  const std::string name = fmt::format("slave.sim_arm.surface[{}]", surface);
  std::string how_far = "at any stiffness";
  if (wall.value > 0)
    how_far =
        fmt::format("its {} are {:.2g} times the {} that are stable here",
                    quantity(Parameter::wall_stiffness, m.wall.stiffness),
                    m.wall.stiffness / wall.value, quantity(Parameter::wall_stiffness, wall.value));
  std::string change;
  const auto add = [&](const std::string& words) {
    if (words.empty()) return;
    change += (change.empty() ? "" : " or ") + words;
  };
  add(remedy(scene, surface, Parameter::wall_stiffness, "make its stiffness"));
  add(remedy(scene, surface, Parameter::reflection_gain, "set slave.workspace.force_scale"));
  add(remedy(scene, surface, Parameter::round_trip, "bring the round trip"));
  if (m.force)
    add(remedy(scene, surface, Parameter::loop_gain, "set the kp of force_feedback.closed_loop"));
  if (change.empty()) change = "lower the gains of joint_pid";
  return fmt::format("pressing on {} is predicted to oscillate, {}; {}", name, how_far, change);
}

}  // namespace

AxisStudy study_axis(const Scene& scene, int surface) {
  AxisStudy out{.surface = surface, .model = axis_model(scene, surface)};
  const LoopMatrices loop = loop_matrices(AxisPeriod(out.model));
  out.poles = poles(loop.closed(), out.model.Ts);
  out.radius = std::abs(out.poles.front().z);
  if (out.model.reflects && out.stable()) out.margins = margins(loop, out.model.Ts);
  out.small_gain = small_gain(out.model);
  out.felt = felt_stiffness(out.model);
  for (const Parameter p : parameters_of(out.model))
    out.limits.push_back({p, get(scene, surface, p), predicted_limit(scene, surface, p), {}});
  return out;
}

void simulate(const Scene& scene, AxisStudy& study) {
  for (ParameterLimit& limit : study.limits)
    if (limit.predicted.value > 0 && std::isfinite(limit.predicted.value))
      limit.simulated =
          simulated_limit(scene, study.surface, limit.parameter, limit.predicted.value);
  if (!study.model.reflects) return;
  if (study.stable()) study.felt_measured = measured_felt_stiffness(scene, study.surface);
  const double linear = study.limits[0].simulated.value_or(0);
  if (linear == 0) return;
  const auto chatter_stiffness = [&](double knock) {
    return chatter_limit(scene, study.surface, Parameter::wall_stiffness, linear, knock);
  };
  study.chatter_stiffness = chatter_stiffness(0);
  study.knocked_stiffness = chatter_stiffness(kKnock);
}

std::vector<std::string> stability_warnings(const Scene& scene) {
  std::vector<std::string> out;
  const proto::Scene& s = scene.proto;
  if (!s.master().has_force_feedback() || !s.master().has_sim_hand() || !s.slave().has_sim_arm() ||
      s.has_bilateral() || s.has_compensation())  // which the analysis does not know
    return out;
  for (int i = 0; i < surfaces(scene); ++i) {
    const AxisModel m = axis_model(scene, i);
    if (radius(m) >= 1) out.push_back(warning(scene, i, m));
  }
  return out;
}

}  // namespace farhand
