#include <array>

#include "common/scene.hpp"
#include "tests/loop/experiments/columns.hpp"
#include "tests/loop/experiments/experiment.hpp"
#include "tests/loop/run.hpp"

namespace farhand {
namespace {

constexpr double kTarget[3] = {0.025, -0.025, 0.115};
constexpr double kPushesEnd = 30;

// The plant whose damping gives the published 1.2 s, and a lighter one.
struct PlantOf {
  const char* name;
  double damping;
  double reference_step, reference_push, reference_peak;  // [s], [s], [m]
};
constexpr std::array kPlants = {PlantOf{"calibrated", 55, 1.04, 1.2, 0.010},
                                PlantOf{"light", 8, 0.21, 0.6, 0.019}};

std::string scene_text(double damping, const std::string& pushes) {
  return R"(
rate_hz: 100 duration_s: 30
master {
  falcon {}
  velocity_cutoff_hz: 30
  position_control { set_point { at_s: 0 position_m: [0.025, -0.025, 0.115] } }
  sim_hand {
    device_mass_kg: 0.3 device_friction_newton: 0 device_weight_newton: 2.943 encoder_step_rad: 0
    start_position_m: [0.015, -0.057, 0.118]
    device_damping_newton_s_per_m: )" +
         std::to_string(damping) + "\n" + pushes + "}\n}\n";
}

constexpr const char* kPushes = R"(
    push { at_s: 6.5 force_newton: [3, 0, 0] }  push { at_s: 11 force_newton: [-3, 0, 0] }
    push { at_s: 14.9 force_newton: [0, 3, 0] } push { at_s: 19 force_newton: [0, -3, 0] }
    push { at_s: 22 force_newton: [0, 0, 3] }   push { at_s: 26.5 force_newton: [0, 0, -3] }
)";

Chart position_chart(const Scene& scene, const std::string& title, double to) {
  std::array<Signal, 3> p;
  Loopback loop(scene, {});
  loop.on_master = [&](const MasterTick& t) {
    for (std::size_t i = 0; i < 3; ++i)
      p[i].add(seconds(t.now - loop.start()), t.handle.X_MH.p[static_cast<Eigen::Index>(i)]);
  };
  loop.run();
  Chart chart{.title = title, .level_name = "target"};
  for (std::size_t i = 0; i < 3; ++i) {
    chart.panels.push_back(
        over_time(std::string(1, "xyz"[i]) + " [cm]", 0, to, {drawn(p[i], "grip", 0, 0, to, 100)}));
    chart.panels.back().levels = {100 * kTarget[i]};
  }
  return chart;
}

Experiment falcon(const std::string& pushes, const char* title, const char* about, double shown) {
  Experiment out{.title = title, .about = about};
  for (const PlantOf& plant : kPlants) {
    const Scene scene = parse_scene(scene_text(plant.damping, pushes), "experiment");
    const RunResult run = run_scene(scene, {});
    const std::string name = std::string(", ") + plant.name + " plant";
    const Settling& step = run.settling.front();
    if (pushes.empty()) {
      out.figures.push_back({"within 1.5 mm of the target from" + name, "s", "1.2",
                             plant.reference_step, step.settled_after_s, 0, 1.2});
    } else {
      double longest = 0, peak = 0;
      for (std::size_t i = 1; i < run.settling.size(); ++i)
        longest = std::max(longest, run.settling[i].settled_after_s),
        peak = std::max(peak, run.settling[i].peak_m);
      out.figures.push_back({"back within 1.5 mm after a push began, longest" + name, "s",
                             "stable, returns", plant.reference_push, longest, 0, 1.3});
      out.figures.push_back(
          {"farthest from the target" + name, "mm", "", 1e3 * plant.reference_peak, 1e3 * peak});
    }
    out.figures.push_back(
        {"limits broken" + name, "ticks", "", 0, static_cast<double>(run.violations), 0, 0});
    out.charts.push_back(
        position_chart(scene, std::string("Grip, ") + plant.name + " plant", shown));
  }
  return out;
}

}  // namespace

Experiment falcon_step() {
  return falcon("", "F1  Falcon, step",
                "The grip is driven 33 mm to a target at 100 Hz with the published gains; nobody "
                "touches it.",
                3);
}

Experiment falcon_pushes() {
  return falcon(kPushes, "F2  Falcon, pushes",
                "The same; then six half-sine pushes of 3 N and 0.5 s from all sides.", kPushesEnd);
}

}  // namespace farhand
