#include "tests/loop/stability/grid.hpp"

#include <google/protobuf/text_format.h>
#include <spdlog/fmt/fmt.h>

#include <algorithm>
#include <cmath>
#include <nlohmann/json.hpp>

#include "tests/loop/experiments/full_scene.hpp"
#include "tests/loop/stability/simulated.hpp"

namespace farhand {
namespace {

struct Masses {
  double device, hand;  // [kg]
};
constexpr Masses kMasses[] = {{0.5, 0.2}, {1, 0.4}, {1, 1}, {2, 0.4}, {3, 2}};
constexpr double kRoundTrips[] = {1e-4, 2e-3, 5e-3, 12e-3, 30e-3};  // [s]
struct Gains {
  double reflection, loop;
};
constexpr Gains kGains[] = {{0.5, 0}, {1, 0}, {2, 0}, {1, 0.6}, {1, 1.2}, {1, 2.4}};
constexpr double kWalls[] = {600, 1500, 4000};  // [N/m]
constexpr double kOurGain = 8.8;                // kp

Scene hidden(Scene scene, bool observes_disturbance) {
  proto::Master& master = *scene.proto.mutable_master();
  master.mutable_force_sensing();
  proto::ForceFeedback& feedback = *master.mutable_force_feedback();
  feedback.clear_closed_loop();
  google::protobuf::TextFormat::MergeFromString(kOurLoop, &feedback);
  if (observes_disturbance) feedback.mutable_disturbance_observer();
  return scene;
}

void add_hidden(GridPoint p, std::vector<GridPoint>& all) {
  p.hides_device = true, p.loop_gain = kOurGain;
  p.parameter = Parameter::wall_stiffness, all.push_back(p);
  p.observes_disturbance = true, all.push_back(p);
  p.wall_stiffness = kWalls[0], p.parameter = Parameter::reflection_gain, all.push_back(p);
}

// Stages that know the device, and the disturbance's.
const char* stages(const GridPoint& p) {
  return !p.hides_device ? "" : p.observes_disturbance ? "dev+d" : "dev";
}

}  // namespace

std::string GridPoint::variant() const {
  if (hides_device)
    return fmt::format("device hidden, kp {:g}{}", loop_gain,
                       observes_disturbance ? ", disturbance" : "");
  return loop_gain > 0 ? fmt::format("closed loop, kp {:g}", loop_gain)
                       : fmt::format("open loop, reflection {:g}", reflection_gain);
}

std::vector<GridPoint> grid_points(bool small) {
  std::vector<GridPoint> all;
  for (const Masses& m : kMasses) {
    const GridPoint base{.device_mass = m.device, .hand_mass = m.hand};
    for (const double round_trip : kRoundTrips) {
      GridPoint p = base;
      p.round_trip = round_trip;
      p.parameter = Parameter::wall_stiffness;
      for (const Gains& g : kGains) {
        p.reflection_gain = g.reflection, p.loop_gain = g.loop;
        all.push_back(p);
      }
      p.reflection_gain = 1;
      add_hidden(p, all);
      for (const double wall : kWalls) {
        p.wall_stiffness = wall;
        p.loop_gain = 0, p.parameter = Parameter::reflection_gain, all.push_back(p);
        p.loop_gain = 1.2, p.parameter = Parameter::loop_gain, all.push_back(p);
      }
    }
    for (const double wall : kWalls) {
      GridPoint p = base;
      p.wall_stiffness = wall, p.parameter = Parameter::round_trip;
      all.push_back(p);
    }
  }
  if (!small) return all;
  std::vector<GridPoint> few;
  for (std::size_t i = 0; i < 12; ++i) few.push_back(all[i * (all.size() - 1) / 11]);
  return few;
}

GridPoint compare(const Scene& scene, int surface, GridPoint p) {
  const Scene base = p.hides_device ? hidden(scene, p.observes_disturbance) : scene;
  Scene varied = with(base, surface, Parameter::device_mass, p.device_mass);
  varied = with(varied, surface, Parameter::hand_mass, p.hand_mass);
  varied = with(varied, surface, Parameter::round_trip, p.round_trip);
  varied = with(varied, surface, Parameter::reflection_gain, p.reflection_gain);
  varied = with(varied, surface, Parameter::loop_gain, p.loop_gain);
  varied = with(varied, surface, Parameter::wall_stiffness, p.wall_stiffness);
  const StabilityLimit limit = predicted_limit(varied, surface, p.parameter);
  if (limit.value == 0 || !std::isfinite(limit.value)) return p;
  p.predicted = limit.value;
  p.simulated = simulated_limit(varied, surface, p.parameter, p.predicted);
  return p;
}

Agreement agreement(const std::vector<GridPoint>& points) {
  std::vector<double> off;
  for (const GridPoint& p : points)
    if (p.compared()) off.push_back(std::abs(p.difference()));
  if (off.empty()) return {};
  std::sort(off.begin(), off.end());
  return {off.size(), off[off.size() / 2], off.back()};
}

std::string to_text(const std::vector<GridPoint>& points) {
  std::string out =
      "  device    hand  round trip   gain   loop          wall   boundary of         predicted   "
      "simulated\n      kg      kg          ms            kp           N/m\n";
  for (const GridPoint& p : points) {
    const ParameterText words = text(p.parameter);
    out += fmt::format("  {:6.2f}  {:6.2f}  {:10.1f}  {:5.2f}  {:5.2f} {:<5} {:6.0f}   {:<16}",
                       p.device_mass, p.hand_mass, p.round_trip * 1e3, p.reflection_gain,
                       p.loop_gain, stages(p), p.wall_stiffness, words.name);
    out += p.compared()
               ? fmt::format("{:>11.4g} {:>11.4g} {:3} {:+7.2f} %\n", p.predicted * words.per_unit,
                             p.simulated * words.per_unit, words.unit, 100 * p.difference())
           : p.predicted > 0 ? "    not found\n"
                             : "       none\n";
  }
  const Agreement a = agreement(points);
  return out + fmt::format(
                   "{} boundaries compared of {}: differing by {:.2f} % in the median, {:.2f} % "
                   "at most\n",
                   a.points, points.size(), 100 * a.median, 100 * a.worst);
}

std::string to_json(const std::vector<GridPoint>& points) {
  nlohmann::ordered_json out;
  const Agreement a = agreement(points);
  out["compared"] = a.points;
  out["median_difference"] = a.median;
  out["worst_difference"] = a.worst;
  for (const GridPoint& p : points)
    out["points"].push_back({{"device_mass_kg", p.device_mass},
                             {"hand_mass_kg", p.hand_mass},
                             {"round_trip_s", p.round_trip},
                             {"reflection_gain", p.reflection_gain},
                             {"force_loop_kp", p.loop_gain},
                             {"hides_device", p.hides_device},
                             {"observes_disturbance", p.observes_disturbance},
                             {"wall_newton_per_m", p.wall_stiffness},
                             {"boundary_of", text(p.parameter).name},
                             {"predicted", p.predicted},
                             {"simulated", p.simulated}});
  return out.dump(2) + "\n";
}

}  // namespace farhand
