#include "tests/loop/stability/command.hpp"

#include <cstdio>
#include <fstream>
#include <stdexcept>

#include "common/report/svg_chart.hpp"
#include "tests/loop/stability/grid.hpp"
#include "tests/loop/stability/map.hpp"
#include "tests/loop/stability/study.hpp"

namespace farhand {
namespace {

constexpr double kAgreement = 0.1;

void print(const std::string& text) {
  std::fputs(text.c_str(), stdout);
}

void write(const std::string& path, const Chart& chart) {
  std::ofstream out(path);
  out << standalone_svg(chart);
  if (!out.flush()) throw std::runtime_error(path + " cannot be written");
}

int run_grid(const Scene& scene, const StabilityOptions& options) {
  std::vector<GridPoint> points = grid_points(false);
  std::size_t done = 0;
  for (GridPoint& p : points) {
    p = compare(scene, 0, p);
    std::fprintf(stderr, "\r%zu of %zu", ++done, points.size());
  }
  std::fputs("\n", stderr);
  print(options.json ? to_json(points) : to_text(points));
  if (options.map) write(*options.map, grid_map(points));
  return agreement(points).worst <= kAgreement ? 0 : 1;
}

}  // namespace

int run_stability(const Scene& scene, const StabilityOptions& options) {
  if (surfaces(scene) == 0)
    throw std::runtime_error(
        scene.path + " has no surface to press on, so no loop is closed; add one to sim_arm");
  if (options.grid) return run_grid(scene, options);
  std::vector<AxisStudy> studies;
  bool stable = true;
  for (int i = 0; i < surfaces(scene); ++i) {
    studies.push_back(study_axis(scene, i));
    simulate(scene, studies.back());
    stable = stable && studies.back().stable();
    if (!options.json) print(to_text(scene, studies.back()));
  }
  if (options.json) print(to_json(scene, studies));
  if (options.map) write(*options.map, stability_map(scene, 0));
  return stable ? 0 : 1;
}

}  // namespace farhand
