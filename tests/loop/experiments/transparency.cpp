// What the hand feels by architecture: user's force over handle's motion at single frequencies,
// with everything else at rest.
#include <array>
#include <cmath>
#include <complex>
#include <numbers>

#include "common/scene.hpp"
#include "tests/loop/experiments/columns.hpp"
#include "tests/loop/experiments/experiment.hpp"
#include "tests/loop/experiments/full_scene.hpp"
#include "tests/loop/loopback.hpp"

namespace farhand {
namespace {

struct Architecture {
  const char* name;
  const char* scene;
};
constexpr std::array kArchitectures = {
    Architecture{"position-force", ""},
    Architecture{"position-position", "bilateral { position_position {} }"},
    Architecture{"force-position", "bilateral { force_position {} }"},
    Architecture{"four channels", "bilateral { force_force {} }"}};

constexpr std::array kFrequencies = {0.5, 1.0, 2.0, 4.0, 8.0};  // [Hz]
constexpr double kWallStiffness = 500;                          // [N/m]

// The hand along x of M, the direction of contact: presses 40 mm in, 10 mm beyond the wall, if
// there is one, and swings by a few millimetres.
Scene scene(const Architecture& a, bool wall, double hz) {
  const double amplitude = std::min(0.005, 0.03 / hz);
  const std::string reach = wall ? "reach { at_s: 1 lasting_s: 2 by_m: [-0.05, 0, 0] }" : "";
  const std::string surface =
      wall ? "surface { plane { point_m: [0, 0.356057, 0] normal: [0, -1, 0] } "
             "stiffness_newton_per_m: 500 }"
           : "";
  return parse_scene(std::string(a.scene) + R"(
master { twin_delta {} force_sensing {}
  force_feedback {)" + kOurLoop +
                         R"( }
  sim_hand { force_noise_newton: 0 operator { motion { )" +
                         reach + " sine { from_s: 3.5 frequency_hz: " + std::to_string(hz) +
                         " amplitude_m: [" + std::to_string(amplitude) + R"(, 0, 0] } } } } }
slave { sim_arm { )" + surface +
                         R"( force_sensor { force_noise_newton: 0 torque_noise_newton_meter: 0 } }
  workspace {} force_sensing {}
  joint_pid { gravity_compensation {} friction_compensation {} velocity_feedforward {} } })",
                     "experiment");
}

// F / X at the frequency, over whole periods after everything has settled.
std::complex<double> impedance(const Scene& scene, double hz) {
  const double from = 6, periods = std::ceil(2 * hz), to = from + periods / hz;
  std::complex<double> F = 0, X = 0;
  Loopback loop(scene, {.duration_s = to});
  loop.on_master = [&](const MasterTick&) {
    const HandTruth& truth = std::get<SimHand<TwinDeltaGeometry>>(loop.device()).truth();
    if (truth.t < from) return;
    const auto turn = std::polar(1.0, -2 * std::numbers::pi * hz * truth.t);
    F += truth.user.force.x() * turn;
    X += truth.state.p_MH.x() * turn;
  };
  loop.run();
  return F / X;
}

struct Sweep {
  std::array<std::complex<double>, kFrequencies.size()> Z;
};
Sweep sweep(const Architecture& a, bool wall) {
  Sweep out;
  for (std::size_t i = 0; i < kFrequencies.size(); ++i)
    out.Z[i] = impedance(scene(a, wall, kFrequencies[i]), kFrequencies[i]);
  return out;
}

Line line(const Sweep& s, const char* name, int style) {
  Line out{.name = name, .style = style, .markers = true};
  for (std::size_t i = 0; i < kFrequencies.size(); ++i)
    out.points.push_back({kFrequencies[i], std::abs(s.Z[i])});
  return out;
}

std::string at(double hz) {
  char text[32];
  std::snprintf(text, sizeof text, " at %g Hz", hz);
  return text;
}

void tell(Experiment& out, const Architecture& a, const Sweep& free, const Sweep& wall) {
  for (std::size_t i = 0; i < kFrequencies.size(); ++i) {
    const double hz = kFrequencies[i], w = 2 * std::numbers::pi * hz;
    const std::string where = std::string(a.name) + ", free" + at(hz);
    out.figures.push_back({where + ": felt mass", "kg", "", NAN, -free.Z[i].real() / (w * w)});
    out.figures.push_back({where + ": felt damping", "N s/m", "", NAN, free.Z[i].imag() / w});
  }
  for (std::size_t i = 0; i < kFrequencies.size(); ++i)
    out.figures.push_back(
        {std::string(a.name) + ", on the wall" + at(kFrequencies[i]) + ": felt stiffness", "N/m",
         "", NAN, wall.Z[i].real()});
}

}  // namespace

Experiment transparency() {
  Experiment out{.title = "Transparency by architecture",
                 .about =
                     "Impedance the hand feels along the direction of contact, our force "
                     "loop, 50 us of network: free, and on a wall of 500 N/m."};
  Chart chart{.title = "Impedance felt, |F_u / X|",
              .shared_x = true,
              .level_name = "the wall's",
              .panel_height = 180};
  Panel free{.x = {.label = "frequency [Hz]", .log = true},
             .y = {.label = "free [N/m]", .log = true}};
  Panel wall{.x = {.label = "frequency [Hz]", .log = true},
             .y = {.label = "on 500 N/m [N/m]", .log = true}};
  wall.levels = {kWallStiffness};
  for (std::size_t i = 0; i < kArchitectures.size(); ++i) {
    const Architecture& a = kArchitectures[i];
    const Sweep f = sweep(a, false), w = sweep(a, true);
    tell(out, a, f, w);
    free.lines.push_back(line(f, a.name, static_cast<int>(i)));
    wall.lines.push_back(line(w, a.name, static_cast<int>(i)));
  }
  chart.panels = {std::move(free), std::move(wall)};
  out.charts = {std::move(chart)};
  return out;
}

}  // namespace farhand
