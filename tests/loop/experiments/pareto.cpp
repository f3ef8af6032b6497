// Which stages of the force controller hide the device best at equal noise and equal margin: each
// combination with its loop's gain swept, on one axis and on the full simulation.
#include <spdlog/fmt/fmt.h>

#include <array>
#include <cmath>
#include <functional>

#include "master/build_force.hpp"
#include "tests/loop/experiments/experiment.hpp"
#include "tests/loop/experiments/full_scene.hpp"
#include "tests/loop/loopback.hpp"
#include "tests/loop/truth.hpp"
#include "tests/support/axis_loops.hpp"

namespace farhand {
namespace {

constexpr double kLeastMargin = 6;                  // [dB]
constexpr double kMostFelt = 15, kMostNoise = 1.1;  // [mN rms], of the open loop's
constexpr double kSettled = 30;  // [s], five times the published integral's time constant
constexpr double kHold = 3, kHoldJudged = 2;  // [s] of a run that tells the margin

// A combination, its stages as a scene says them at a gain of its loop.
struct Combination {
  const char* name;
  bool published;      // gains and filter of the loop
  const char* stages;  // beside it
};
constexpr std::array kCombinations = {
    Combination{"published loop", true, ""},
    Combination{"published, feed-forward", true, "device_model {} device_feedforward {}"},
    Combination{"error loop", false, ""},
    Combination{"error loop, disturbance", false, "device_model {} disturbance_observer {}"},
    Combination{"error loop, feed-forward", false, "device_model {} device_feedforward {}"},
    Combination{"error loop, both", false,
                "device_model {} device_feedforward {} disturbance_observer {}"}};

std::string stages(const Combination& c, double kp) {
  if (c.published)
    return fmt::format("closed_loop {{ force {{ kp: {} ki_per_s: {} kd_s: {} }} }} {}", kp,
                       kp * 0.3, kp * 0.0011 / 1.2, c.stages);
  return fmt::format(R"(closed_loop {{ filter: ERROR cutoff_hz: 8.5
      force {{ kp: {} ki_per_s: {} kd_s: 0 }}
      torque {{ kp: 2 ki_per_s: 20 kd_s: 0.027 derivative_cutoff_hz: 30 }}
      twist {{ kp: 1 ki_per_s: 10 kd_s: 0.0135 derivative_cutoff_hz: 30 }} }} {})",
                     kp, kp * kTurn * 3, c.stages);
}

std::vector<double> gains(const Combination& c, int finer) {
  std::vector<double> out;
  for (int i = 0; i <= 3 * finer; ++i)
    out.push_back((c.published ? 0.6 : 4.4) * std::exp2(static_cast<double>(i) / finer));
  return out;
}

// ---- either plant

struct Plant {
  std::function<Swing(const std::string& stages)> move;
  std::function<double(const std::string& stages)> margin;  // [dB]
};

Plant one_axis() {
  const auto config = [](const std::string& stages) {
    const Scene scene = parse({.stages = stages});
    axis::LoopConfig c{.force_noise = 0.03, .encoder_step = 20e-6};
    c.controller = force_feedback_config(scene.proto.master(), c.Ts).controller;
    c.controller.limits = axis::open_loop().limits;
    if (c.controller.device) c.controller.device->motor_delay = c.queue;
    return c;
  };
  return {
      [=](const std::string& stages) { return axis::swing(config(stages), 1, 0.05, kSettled, 4); },
      [=](const std::string& stages) { return axis::margin_db(config(stages)); }};
}

// Along z of M and G, which the grip's tilt keeps within some degrees of each other.
Swing full_swing(const std::string& stages) {
  constexpr int kPeriods = 4;
  Periodic figures(1000, kPeriods);
  Loopback loop(parse({.stages = stages, .motion = kH1Motion}),
                {.duration_s = kSettled + kPeriods + 0.1});
  loop.on_master = [&](const MasterTick& t) {
    if (seconds(t.now - loop.start()) < kSettled || figures.complete()) return;
    figures.add(true_user(loop.device(), t.handle.R_MG)->force.z(),
                true_handle(loop.device(), t.handle.X_MH.p).z(), t.F_user_G.force.z());
  };
  loop.run();
  return figures.swing();
}

// Of the motors, which give `gain` times what they are told.
Unrest full_unrest(const std::string& stages, double gain) {
  constexpr const char* kStart = "reach { at_s: 1 lasting_s: 0.2 by_m: [0.002, 0, 0.002] }";
  constexpr const char* kNoFriction = " device_friction_newton: 0 rotation_friction_newton_m: 0";
  Unrest out{};
  for (std::size_t i = 0; i < out.size(); ++i) {
    const Scene scene =
        parse({.stages = stages,
               .motion = i == 1 ? kH1Motion : kStart,
               .hand = fmt::format("motor_gain: {}{}", gain, i == 2 ? kNoFriction : "")});
    Loopback loop(scene, {.duration_s = kHold});
    Vec6 last = Vec6::Zero();
    double sum = 0;
    int count = 0;
    loop.on_master = [&](const MasterTick& t) {
      if (seconds(t.now - loop.start()) > kHoldJudged) sum += (t.tau - last).squaredNorm(), ++count;
      last = t.tau;
    };
    loop.run();
    out[i] = gain * std::sqrt(sum / count);
  }
  return out;
}

Plant six_axes() {
  return {full_swing, [](const std::string& stages) {
            return gain_margin_db([&](double gain) { return full_unrest(stages, gain); }, 5);
          }};
}

// ---- the picture

// Of one combination at one gain, against the open loop.
struct Found {
  double kp, left, felt, noise, margin;  // [1], [%] of the swing per mm, [mN rms], [1], [dB]
  bool good() const { return felt <= kMostFelt && noise <= kMostNoise && margin >= kLeastMargin; }
};

std::vector<Found> sweep(const Plant& plant, const Combination& c, const Swing& open, int finer) {
  std::vector<Found> out;
  for (const double kp : gains(c, finer)) {
    const std::string text = stages(c, kp);
    const Swing s = plant.move(text);
    out.push_back(
        {kp, 100 * s.per_mm / open.per_mm, 1e3 * s.felt, s.noise / open.noise, plant.margin(text)});
  }
  return out;
}

Line line(const std::vector<Found>& found, std::size_t style, double Found::*y) {
  Line out{.name = kCombinations[style].name, .style = static_cast<int>(style), .markers = true};
  for (const Found& f : found) out.points.push_back({f.left, f.*y});
  return out;
}

void tell(Experiment& out, const Combination& c, const std::vector<Found>& found) {
  const Found* best = nullptr;
  double margin = 0;
  for (const Found& f : found) {
    if (f.good() && (best == nullptr || f.left < best->left)) best = &f;
    margin = std::max(margin, f.margin);
  }
  const std::string name = c.name;
  if (best == nullptr) {
    out.figures.push_back(
        {name + ": no gain within the bounds; largest margin", "dB", "", NAN, margin});
    return;
  }
  out.figures.push_back({name + ": swing per mm left", "%", "", NAN, best->left});
  out.figures.push_back({name + ": at kp", "1", "", NAN, best->kp});
  out.figures.push_back({name + ": gain margin", "dB", "", NAN, best->margin});
  out.figures.push_back({name + ": felt noise", "mN rms", "", NAN, best->felt});
  out.figures.push_back({name + ": measured noise, of the open loop's", "1", "", NAN, best->noise});
}

Experiment study(const Plant& plant, int finer, std::string title, std::string about) {
  Experiment out{.title = std::move(title), .about = std::move(about)};
  const auto panel = [](const char* y, double level) {
    return Panel{
        .x = {.label = "swing per mm left [%]", .log = true}, .y = {.label = y}, .levels = {level}};
  };
  Panel margin = panel("gain margin [dB]", kLeastMargin),
        felt = panel("felt noise [mN]", kMostFelt),
        noise = panel("measured noise, of open", kMostNoise);
  const Swing open = plant.move("");
  for (std::size_t i = 0; i < kCombinations.size(); ++i) {
    const std::vector<Found> found = sweep(plant, kCombinations[i], open, finer);
    tell(out, kCombinations[i], found);
    margin.lines.push_back(line(found, i, &Found::margin));
    felt.lines.push_back(line(found, i, &Found::felt));
    noise.lines.push_back(line(found, i, &Found::noise));
  }
  out.charts = {{.title = "What is left of the device, against margin and noise",
                 .panels = {std::move(margin), std::move(felt), std::move(noise)},
                 .level_name = "bound",
                 .panel_height = 180}};
  return out;
}

}  // namespace

Experiment pareto_one_axis() {
  return study(
      one_axis(), 2, "Combinations of stages, one axis",
      "H1 at 1 Hz with force noise of 0.03 N and encoder steps of 20 um, the loop's gain "
      "swept over three octaves. Told is the least felt swing with a margin of 6 dB, 15 mN "
      "of felt noise and 1.1 times the open loop's measured noise.");
}

Experiment pareto_full() {
  return study(six_axes(), 1, "Combinations of stages, six axes",
               "The same on the full simulation, along F_z. The margin is that of all six axes' "
               "command together.");
}

}  // namespace farhand
