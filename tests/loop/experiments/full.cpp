// The same on six axes: both ticks, the links, the simulated hand and arm, in virtual time.
#include <spdlog/fmt/fmt.h>

#include <array>
#include <cmath>

#include "common/statistics.hpp"
#include "tests/loop/experiments/columns.hpp"
#include "tests/loop/experiments/experiment.hpp"
#include "tests/loop/experiments/full_scene.hpp"
#include "tests/loop/loopback.hpp"
#include "tests/loop/truth.hpp"

namespace farhand {
namespace {

struct Rival {
  const char* name;
  const char* stages;  // of force_feedback
};
constexpr std::array kRivals = {Rival{"open loop", ""}, Rival{"published gains", "closed_loop {}"},
                                Rival{"ours", kOurLoop}};

constexpr const char* kContactMotion = R"(
  sine { from_s: 1 frequency_hz: 0.3 amplitude_deg: [8, 10, 15] }
  sine { from_s: 1 until_s: 11 frequency_hz: 0.4 amplitude_m: [0.03, 0, 0] }
  reach { at_s: 11 lasting_s: 4 by_m: [-0.06, 0, 0] }
  sine { from_s: 15 frequency_hz: 0.5 amplitude_m: [0.008, 0, 0] })";
constexpr const char* kWall = R"(
  surface { plane { point_m: [0, 0.356057, 0] normal: [0, -1, 0] } stiffness_newton_per_m: 500 })";

// Force, then torque.
Vec6 column(const Wrench& F) {
  Vec6 out;
  out << F.force, F.torque;
  return out;
}

constexpr std::array kAxes = {"F_x", "F_y", "F_z", "M_x", "M_y", "M_z, twist"};

struct Run {
  std::array<Rms, 6> difference;  // of F_u and F_e
  std::array<double, 6> mean{}, peak{};
  std::array<Signal, 6> F_u, F_e;
  Signal handle, robot;  // [m] along the direction of contact
};

Run run(const Scene& scene, double judged_from, double end) {
  Run out;
  Loopback loop(scene, {.duration_s = end});
  int count = 0;
  loop.on_master = [&](const MasterTick& t) {
    const double now = seconds(t.now - loop.start());
    const Vec6 F_u = column(*true_user(loop.device(), t.handle.R_MG));
    const Vec6 F_e = column(t.F_env_G);
    for (std::size_t i = 0; i < 6; ++i) {
      const auto k = static_cast<Eigen::Index>(i);
      out.F_u[i].add(now, F_u[k]), out.F_e[i].add(now, F_e[k]);
      if (now < judged_from) continue;
      out.difference[i].add(F_u[k] - F_e[k]);
      out.mean[i] += F_u[k];
      out.peak[i] = std::max(out.peak[i], std::abs(F_u[k]));
    }
    count += now >= judged_from;
    out.handle.add(now, 0.18 - t.handle.X_MH.p.x());
  };
  loop.on_slave = [&](const SlaveTick& t) {
    out.robot.add(seconds(t.now - loop.start()), t.X_SE.p.y() - 0.326057);
  };
  loop.run();
  for (double& m : out.mean) m /= count;
  return out;
}

std::array<Run, 3> run_all(const char* motion, const char* wall, double judged_from, double end) {
  std::array<Run, 3> out;
  for (std::size_t i = 0; i < 3; ++i)
    out[i] =
        run(parse({.stages = kRivals[i].stages, .motion = motion, .wall = wall}), judged_from, end);
  return out;
}

// A device that is not what the controller's model says: mass, damping, friction and weight off by
// 20 % each way.
std::string corner(int k) {
  const auto off = [k](int bit) { return (k >> bit) & 1 ? 1.2 : 0.8; };
  return fmt::format(
      "device_mass_kg: {} device_damping_newton_s_per_m: {} device_friction_newton: {} "
      "device_weight_newton: {} rotation_inertia_kg_m2: {} rotation_damping_newton_m_s: {} "
      "rotation_friction_newton_m: {} twist_inertia_kg_m2: {} twist_damping_newton_m_s: {}",
      off(0), 4 * off(1), 0.8 * off(2), 2 * off(3), 0.01 * off(0), 0.02 * off(1), 0.02 * off(2),
      5e-4 * off(0), 2e-3 * off(1));
}

// On its worst corner, what is left of each axis' F_u - F_e.
void tell_corners(Experiment& out) {
  std::array<double, 6> worst{};
  for (int k = 0; k < 16; ++k) {
    const Run open = run(parse({.motion = kH1Motion, .hand = corner(k)}), 5, 9);
    const Run ours = run(parse({.stages = kOurLoop, .motion = kH1Motion, .hand = corner(k)}), 5, 9);
    for (std::size_t i = 0; i < 6; ++i)
      worst[i] = std::max(worst[i], ours.difference[i].value() / open.difference[i].value());
  }
  for (std::size_t i = 0; i < 6; ++i)
    out.figures.push_back(
        {std::string("ours, device off by 20 %, worst corner: left of ") + kAxes[i], "%", "", NAN,
         100 * worst[i]});
}

const char* unit(std::size_t axis) {
  return axis < 3 ? "N" : "N m";
}

void tell_axes(Experiment& out, const std::array<Run, 3>& runs) {
  for (std::size_t c = 0; c < 3; ++c)
    for (std::size_t i = 0; i < 6; ++i)
      out.figures.push_back({std::string(kRivals[c].name) + ": rms of F_u - F_e, " + kAxes[i],
                             unit(i), "", NAN, runs[c].difference[i].value()});
}

Chart six_axes(const Run& r, const char* name, double from, double to) {
  Chart chart{.title = "User and robot, six axes", .subtitle = name, .columns = 2};
  for (const std::size_t i : {0, 3, 1, 4, 2, 5})
    chart.panels.push_back(over_time(
        std::string(kAxes[i]) + " [" + unit(i) + "]", from, to,
        {drawn(r.F_u[i], "F_u, user", 0, from, to), drawn(r.F_e[i], "F_e, robot", 1, from, to)}));
  return chart;
}

}  // namespace

Experiment free_motion_full() {
  constexpr double kFrom = 30, kEnd = 40;
  const std::array<Run, 3> runs = run_all(kH1Motion, "", kFrom, kEnd);
  Experiment out{.title = "H1  Free motion, six axes",
                 .about =
                     "Both programs' ticks and the simulated hand and arm: 50 mm up and down "
                     "at 1 Hz, tilting and twisting all along."};
  const double open = runs[0].peak[2];
  out.figures = {
      {"open loop: peak of F_z", "N", "", NAN, open},
      {"published gains: peak of F_z reduced by", "%", "more than 60", NAN,
       100 * (1 - runs[1].peak[2] / open), 60, 100},
      {"published gains: mean of F_z", "N", "no offset", NAN, std::abs(runs[1].mean[2]), 0, 0.05},
      {"ours: peak of F_z reduced by", "%", "", NAN, 100 * (1 - runs[2].peak[2] / open)},
      {"ours: mean of F_z", "N", "", NAN, std::abs(runs[2].mean[2])}};
  tell_axes(out, runs);
  tell_corners(out);
  for (std::size_t c = 0; c < 3; ++c)
    out.charts.push_back(six_axes(runs[c], kRivals[c].name, kFrom, kFrom + 4));
  return out;
}

Experiment contact_full() {
  constexpr double kFrom = 17, kEnd = 26;
  const std::array<Run, 3> runs = run_all(kContactMotion, kWall, kFrom, kEnd);
  Experiment out{.title = "H2, H3  Contact, six axes",
                 .about =
                     "Both programs' ticks and the simulated hand and arm, on a wall of "
                     "500 N/m, 2 ms of network each way, tilting and twisting all along."};
  const double open = runs[0].difference[0].value();
  for (std::size_t c = 1; c < 3; ++c)
    out.figures.push_back(
        {std::string("H3, ") + kRivals[c].name + ": share of the open loop's, F_x", "%", "", NAN,
         100 * runs[c].difference[0].value() / open});
  tell_axes(out, runs);
  for (std::size_t c = 0; c < 3; ++c) {
    Chart chart{.title = "Handle and robot", .subtitle = kRivals[c].name, .panel_height = 150};
    chart.panels = {over_time("position [mm]", 0, kEnd,
                              {drawn(runs[c].handle, "handle", 0, 0, kEnd, 1e3),
                               drawn(runs[c].robot, "robot", 1, 0, kEnd, 1e3)}),
                    over_time("F_x [N]", 0, kEnd,
                              {drawn(runs[c].F_u[0], "F_u, user", 0, 0, kEnd),
                               drawn(runs[c].F_e[0], "F_e, robot", 1, 0, kEnd)})};
    out.charts.push_back(std::move(chart));
  }
  for (std::size_t c = 0; c < 3; ++c)
    out.charts.push_back(six_axes(runs[c], kRivals[c].name, kFrom, kEnd));
  return out;
}

}  // namespace farhand
